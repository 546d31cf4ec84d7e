#include "trimquad/seamless/solve_map.h"

#include <cmath>
#include <complex>
#include <optional>

#include "trimquad/base/error.h"
#include "trimquad/base/sparse_solver.h"
#include "trimquad/seamless/constraint_path.h"
#include "trimquad/seamless/convex_start.h"
#include "trimquad/seamless/map_energy.h"
#include "trimquad/seamless/newton.h"
#include "trimquad/seamless/stiffening.h"
#include "trimquad/seamless/winding.h"

namespace trimquad {
namespace {

constexpr double kConverged = 1e-3;  // relative decrease of the energy in a step, at which optimisation ends

/// The map turned as a whole so that it follows the target best, within `quarters` only where the map has a
/// period.
void turnTowardsTarget(const MapEnergy& energy, const SurfaceMesh& mesh, const SeamBasis& basis,
                       bool quarters, Eigen::VectorXd& x) {
  std::complex<double> sum = 0;
  for (const auto f : mesh.faces()) {
    const auto j = energy.jacobian(f.idx(), x);
    sum += std::complex<double>(j.fzReal, j.fzImag);
  }
  double angle = -std::arg(sum);
  if (quarters) angle = std::round(angle / (M_PI / 2)) * (M_PI / 2);
  const double c = std::cos(angle), s = std::sin(angle);
  for (int i = 0; i < int(x.size()) / 2; ++i) {
    const double u = x[2 * i], v = x[2 * i + 1];
    x[2 * i] = c * u - s * v;
    x[2 * i + 1] = s * u + c * v;
  }
  const Eigen::Vector2d origin(x[basis.coordinate(0, 0)], x[basis.coordinate(0, 1)]);
  for (int w = 0; w < basis.wedgeCount(); ++w)
    for (int axis = 0; axis < 2; ++axis) x[basis.coordinate(w, axis)] -= origin[axis];
}

/// z of a locally injective map grown from a convex embedding, where the basis admits one.
std::optional<Eigen::VectorXd> grownMap(const MapEnergy& energy, const SurfaceMesh& mesh,
                                        const SeamGraph& seams, const MapTarget& target,
                                        const SeamBasis& basis, const Eigen::VectorXd& poisson) {
  double area = 0;
  for (const auto& t : target) {
    const Eigen::Vector2d a = t[1] - t[0], b = t[2] - t[0];
    area += (a.x() * b.y() - a.y() * b.x()) / 2;
  }
  std::optional<double> period;
  Eigen::Vector2d wanted = Eigen::Vector2d::Zero();
  if (basis.branchCount() > 0) {
    const Eigen::VectorXd x = energy.coordinates(poisson);
    wanted = {x[basis.translation(0, 0)], x[basis.translation(0, 1)]};
    period = wanted.norm();
  }
  // The seam may be crossed along u or against it: one of the two signs gives positive triangles.
  for (const double sign : {1.0, -1.0}) {
    if (period) period = sign * std::abs(*period);
    auto x = convexStart(mesh, seams, basis, area, period);
    if (!x) return std::nullopt;
    if (energy.flipped(*x) > 0) continue;
    if (period) {
      // Turn so that the period points where the basis has it.
      const double angle = std::atan2(wanted.y(), wanted.x()) - (sign > 0 ? 0 : M_PI);
      const int quarter = int(std::lround(angle / (M_PI / 2))) & 3;
      for (int i = 0; i < int(x->size()) / 2; ++i) {
        const Eigen::Vector2d p((*x)[2 * i], (*x)[2 * i + 1]);
        const Eigen::Vector2d turned[] = {p, {-p.y(), p.x()}, -p, {p.y(), -p.x()}};
        (*x)[2 * i] = turned[quarter].x();
        (*x)[2 * i + 1] = turned[quarter].y();
      }
      const Eigen::Vector2d origin((*x)[basis.coordinate(0, 0)], (*x)[basis.coordinate(0, 1)]);
      for (int w = 0; w < basis.wedgeCount(); ++w)
        for (int axis = 0; axis < 2; ++axis) (*x)[basis.coordinate(w, axis)] -= origin[axis];
    } else {
      turnTowardsTarget(energy, mesh, basis, false, *x);
    }
    const Eigen::VectorXd z = basis.basis().restrict(*x);
    if (energy.flipped(energy.coordinates(z)) == 0) return z;
  }
  return std::nullopt;
}

[[noreturn]] void throwStillFlipped(const SurfaceMesh& mesh, const std::vector<int>& index,
                                    const SeamBasis& basis, const MapEnergy& energy, const Eigen::VectorXd& x,
                                    const std::string& stage) {
  for (const auto f : mesh.faces())
    if (!(energy.jacobian(f.idx(), x).det() > 0))
      throw stageError(stage,
                       std::to_string(energy.flipped(x)) +
                           " triangles stay turned over in the map; a finer or smoother mesh may help",
                       "triangle " + std::to_string(f.idx()), mesh.calc_face_centroid(f));
  const auto wrong = wrongCones(mesh, index, basis, x);
  TRIMQUAD_ASSERT(!wrong.empty());
  throw stageError(stage, "the map winds around a vertex twice; a finer or smoother mesh may help",
                   "vertex " + std::to_string(wrong.front().idx()), mesh.point(wrong.front()));
}

}  // namespace

void untangle(const MapEnergy& energy, const SeamBasis& basis, Eigen::VectorXd& z, int& iterations,
              const Progress& progress) {
  SparseSolver solver("seamless");
  double least = energy.smallestDeterminant(energy.coordinates(z));
  if (least > 0) return;
  int fewest = energy.flipped(energy.coordinates(z));
  double shallowest = least;
  // Where it works, every few rounds halve the depth of the deepest fold, or turn triangles back. Energies go
  // on falling for hundreds of steps where it does not.
  constexpr int kRounds = 40, kStepsPerRound = 8, kPatience = 3;
  for (int round = 0, idle = 0; round < kRounds && idle < kPatience; ++round) {
    const double depth = std::min(0.0, least), epsilon = std::sqrt(1e-12 + 0.04 * depth * depth);
    const auto density = [&](double I, double D) { return foldoverFree(I, D, epsilon); };
    const double roundStart = least;
    for (int step = 0; step < kStepsPerRound; ++step) {
      progress.check();
      const double decrease = newtonStep(energy, basis, density, 0, false, solver, z);
      ++iterations;
      least = energy.smallestDeterminant(energy.coordinates(z));
      if (least > 0) return;
      if (least > roundStart / 2 || decrease < 1e-5) break;
    }
    const int flipped = energy.flipped(energy.coordinates(z));
    idle = least > shallowest / 2 || flipped < fewest ? 0 : idle + 1;
    fewest = std::min(fewest, flipped);
    shallowest = std::max(shallowest, least);
  }
}

Eigen::VectorXd leastSquares(const MapEnergy& energy, const SeamBasis& basis) {
  // The squared distance to the target alone: its first Newton step from anywhere is the solution.
  const auto none = [](double, double) { return MapDensity{0, 0, 0, 0, 0}; };
  Eigen::VectorXd z = Eigen::VectorXd::Zero(basis.basis().freeCount()), gradient;
  if (z.size() == 0) return z;
  Eigen::SparseMatrix<double> hessian;
  energy.derivatives(energy.coordinates(z), none, 1, gradient, hessian);
  SparseSolver solver("seamless");
  solver.factorize(hessian);
  return z - solver.solve(gradient);
}

Eigen::VectorXd poissonMap(const SurfaceMesh& mesh, const MapTarget& target, const SeamBasis& basis) {
  return leastSquares(MapEnergy(mesh, target, basis), basis);
}

Eigen::VectorXd solveMap(const SurfaceMesh& mesh, const SeamGraph& seams, const MapTarget& target,
                         const std::vector<MapTarget>& starts, const std::optional<Eigen::VectorXd>& nearby,
                         const std::vector<int>& index, const SeamBasis& basis, const std::string& stage,
                         Effort effort, MapCounters& counters, const Progress& progress) {
  const MapEnergy energy(mesh, target, basis);
  Eigen::VectorXd z;
  const auto injective = [&] {
    return energy.flipped(energy.coordinates(z)) == 0 &&
           wrongCones(mesh, index, basis, energy.coordinates(z)).empty();
  };
  if (const auto flat = energy.heldFlat(); !flat.empty())
    throw stageError(stage, "the seams, aligned edges or integers around a triangle leave it no area",
                     "triangle " + std::to_string(flat.front()),
                     mesh.calc_face_centroid(FaceHandle(flat.front())));
  bool found = false;
  std::vector<Eigen::VectorXd> reached;  // by start
  for (size_t k = 0; k < starts.size() && !found; ++k) {
    counters.start = int(k);
    z = poissonMap(mesh, starts[k], basis);
    progress.report(0.2);
    const int flipped = energy.flipped(energy.coordinates(z));
    if (k == 0) counters.flippedBefore = flipped;
    constexpr double kEasy = 1e-3;  // of the triangles
    if (effort == Effort::Easy && flipped > kEasy * double(mesh.n_faces())) break;
    if (!(found = injective()) && k == 0 && nearby) {
      if (const auto moved =
              followConstraints(mesh, target, index, basis, *nearby, counters.pathSteps, progress)) {
        z = *moved;
        found = injective();
      }
    }
    if (!found) {
      untangle(MapEnergy(mesh, starts[k], basis), basis, z, counters.untangleIterations, progress);
      found = injective();
    }
    reached.push_back(z);
  }
  for (size_t k = 0; k < reached.size() && !found; ++k) {
    counters.start = int(k);
    z = reached[k];
    if (const auto stiffened = stiffenedMap(mesh, starts[k], index, basis, z, counters, progress)) {
      z = *stiffened;
      found = true;
    }
  }
  if (!found && effort == Effort::Full) {
    if (const auto grown = grownMap(energy, mesh, seams, target, basis, poissonMap(mesh, target, basis))) {
      z = *grown;
      counters.convexStart = found = true;
    }
  }
  if (!found) throwStillFlipped(mesh, index, basis, energy, energy.coordinates(z), stage);
  progress.report(0.5);
  counters.distortionStart = energy.meanSymmetricDirichlet(energy.coordinates(z));
  SparseSolver solver(stage);
  const int most = counters.convexStart ? 200 : 50;
  for (int i = 0; i < most; ++i) {
    const double decrease = newtonStep(energy, basis, symmetricDirichlet, kFollow, true, solver, z);
    ++counters.iterations;
    progress.report(0.5 + 0.5 * i / most);
    if (decrease < kConverged) break;
  }
  counters.distortionEnd = energy.meanSymmetricDirichlet(energy.coordinates(z));
  return z;
}

Parametrization exactMap(const SurfaceMesh& mesh, const SeamBasis& basis, const Eigen::VectorXd& z,
                         bool integer) {
  Parametrization map;
  map.mesh = mesh;
  const Eigen::VectorXd x = basis.basis().matrix() * z + basis.basis().offset();
  map.scale = FixedScale::fitting(x.size() > 0 ? x.cwiseAbs().maxCoeff() : 1);
  const auto exact = basis.basis().evaluateExact(z, map.scale.bits);
  map.corner.resize(mesh.n_halfedges());
  for (const auto h : mesh.halfedges())
    if (!mesh.is_boundary(h))
      map.corner[h.idx()] = {exact[basis.coordinate(basis.wedge(h), 0)],
                             exact[basis.coordinate(basis.wedge(h), 1)]};
  verify(map, integer);
  return map;
}

}  // namespace trimquad
