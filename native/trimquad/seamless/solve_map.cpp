#include "trimquad/seamless/solve_map.h"

#include <algorithm>
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
#include "trimquad/seamless/untangle.h"
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
                                        const SeamBasis& basis) {
  double area = 0;
  for (const auto& t : target) {
    const Eigen::Vector2d a = t[1] - t[0], b = t[2] - t[0];
    area += (a.x() * b.y() - a.y() * b.x()) / 2;
  }
  std::optional<double> period;
  Eigen::Vector2d wanted = Eigen::Vector2d::Zero();
  if (basis.branchCount() > 0) {
    const Eigen::VectorXd x = energy.coordinates(poissonMap(mesh, target, basis));
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

/// The map in fixed-point numbers, at the finest scale that holds it.
Parametrization roundedMap(const SurfaceMesh& mesh, const SeamBasis& basis, const Eigen::VectorXd& z) {
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
  return map;
}

/// Whether the map still turns no triangle over once it is rounded: one that collapses is often positive in
/// doubles by chance.
bool staysPositive(const SurfaceMesh& mesh, const SeamBasis& basis, const Eigen::VectorXd& z) {
  const Parametrization map = roundedMap(mesh, basis, z);
  for (const auto f : mesh.faces()) {
    const auto h = mesh.halfedge_handle(f), n = mesh.next_halfedge_handle(h);
    if (orientation(map.from(h), map.from(n), map.to(n)) <= 0) return false;
  }
  return true;
}

[[noreturn]] void throwStillFlipped(const MapProblem& problem, const MapEnergy& energy,
                                    const Eigen::VectorXd& x) {
  const auto& mesh = problem.mesh;
  for (const auto f : mesh.faces())
    if (!(energy.jacobian(f.idx(), x).det() > 0))
      throw stageError(problem.stage,
                       std::to_string(energy.flipped(x)) +
                           " triangles stay turned over in the map; a finer or smoother mesh may help",
                       "triangle " + std::to_string(f.idx()), mesh.calc_face_centroid(f));
  const auto wrong = wrongCones(mesh, problem.index, problem.basis, x);
  if (wrong.empty()) {
    const auto thinner = [&](FaceHandle f, FaceHandle g) {
      return energy.jacobian(f.idx(), x).det() < energy.jacobian(g.idx(), x).det();
    };
    const FaceHandle f = *std::min_element(mesh.faces_begin(), mesh.faces_end(), thinner);
    throw stageError(problem.stage, "a triangle collapses in the map; a finer or smoother mesh may help",
                     "triangle " + std::to_string(f.idx()), mesh.calc_face_centroid(f));
  }
  throw stageError(problem.stage, "the map winds around a vertex twice; a finer or smoother mesh may help",
                   "vertex " + std::to_string(wrong.front().idx()), mesh.point(wrong.front()));
}

}  // namespace

Eigen::VectorXd leastSquares(const MapEnergy& energy, SparseSolver& solver) {
  Eigen::VectorXd z = Eigen::VectorXd::Zero(energy.unknownCount()), gradient;
  if (z.size() == 0) return z;
  Eigen::SparseMatrix<double> hessian;
  energy.derivatives(energy.coordinates(z), noDistortion, 1, gradient, hessian);
  solver.factorize(hessian);
  return z - solver.solve(gradient);
}

Eigen::VectorXd poissonMap(const SurfaceMesh& mesh, const MapTarget& target, const SeamBasis& basis) {
  SparseSolver solver("seamless");
  return leastSquares(MapEnergy(mesh, target, basis), solver);
}

bool isInjective(const MapProblem& problem, const MapEnergy& energy, const Eigen::VectorXd& z) {
  const Eigen::VectorXd x = energy.coordinates(z);
  return energy.flipped(x) == 0 && wrongCones(problem.mesh, problem.index, problem.basis, x).empty() &&
         staysPositive(problem.mesh, problem.basis, z);
}

std::vector<MapStart> startsOf(const std::vector<const MapTarget*>& targets) {
  std::vector<MapStart> starts;
  for (const double evenness : {0.5, 1.0})
    for (const auto* target : targets) starts.push_back({target, evenness});
  return starts;
}

UntangledMaps untangledMaps(const MapProblem& problem, const std::optional<Eigen::VectorXd>& nearby,
                            Effort effort, MapCounters& counters, StepBudget& budget,
                            const Progress& progress) {
  const auto& [mesh, seams, target, starts, index, follow, basis, stage] = problem;
  const MapEnergy energy(mesh, target, basis);
  if (const auto flat = energy.heldFlat(); !flat.empty())
    throw stageError(stage, "the seams, aligned edges or integers around a triangle leave it no area",
                     "triangle " + std::to_string(flat.front()),
                     mesh.calc_face_centroid(FaceHandle(flat.front())));
  UntangledMaps maps;
  SparseSolver solver(stage);
  MapEnergy even = energy;
  even.aim(*starts.front().target);
  Eigen::VectorXd z = leastSquares(even, solver);
  progress.report(0.2);
  counters.flippedBefore = energy.flipped(energy.coordinates(z));
  constexpr double kEasy = 1e-3;  // of the triangles
  const bool isHard = counters.flippedBefore > kEasy * double(mesh.n_faces());
  if (isInjective(problem, energy, z)) maps.injective = z;
  if (effort == Effort::Easy && isHard) maps.reached.push_back(z);
  if (!maps.reached.empty() || maps.injective) return maps;
  if (nearby)
    if (const auto moved = followConstraints(mesh, energy, index, basis, follow, *nearby, counters, solver,
                                             budget, progress);
        moved && isInjective(problem, energy, *moved)) {
      maps.injective = moved;
      return maps;
    }
  for (const auto& start : starts) {
    if (budget.spent() && !maps.reached.empty()) break;
    ++counters.starts;
    even.aim(*start.target);
    even.evenOut(start.evenness);
    const auto wrong = [&](const Eigen::VectorXd& map) {
      return wrongTriangles(mesh, index, basis, energy, energy.coordinates(map));
    };
    z = leastSquares(even, solver);
    untangle(even, wrong, z, counters, solver, budget, progress);
    maps.reached.push_back(z);
    if (!isInjective(problem, energy, z)) continue;
    maps.injective = z;
    break;
  }
  return maps;
}

Eigen::VectorXd stubbornMap(const MapProblem& problem, const UntangledMaps& maps, Effort effort,
                            MapCounters& counters, StepBudget& budget, const Progress& progress) {
  const auto& [mesh, seams, target, starts, index, follow, basis, stage] = problem;
  const MapEnergy energy(mesh, target, basis);
  if (effort == Effort::Full)
    if (const auto grown = grownMap(energy, mesh, seams, target, basis)) {
      counters.convexStart = true;
      return *grown;
    }
  for (size_t k = 0; k < maps.reached.size() && !budget.spent(); ++k)
    if (const auto stiffened =
            stiffenedMap(mesh, starts[k], index, basis, maps.reached[k], counters, budget, progress))
      return *stiffened;
  throwStillFlipped(problem, energy, energy.coordinates(maps.reached.back()));
}

void optimize(const MapProblem& problem, Eigen::VectorXd& z, MapCounters& counters,
              const Progress& progress) {
  const MapEnergy energy(problem.mesh, problem.target, problem.basis);
  progress.report(0.5);
  counters.distortionStart = energy.meanSymmetricDirichlet(energy.coordinates(z));
  SparseSolver solver(problem.stage);
  const int most = counters.convexStart ? 200 : 50;
  for (int i = 0; i < most; ++i) {
    const double decrease = newtonStep(energy, straightDirichlet, problem.follow, true, solver, z);
    ++counters.iterations;
    progress.report(0.5 + 0.5 * i / most);
    if (decrease < kConverged) break;
  }
  counters.distortionEnd = energy.meanSymmetricDirichlet(energy.coordinates(z));
}

Eigen::VectorXd solveMap(const MapProblem& problem, const std::optional<Eigen::VectorXd>& nearby,
                         StepBudget budget, MapCounters& counters, const Progress& progress) {
  const auto maps = untangledMaps(problem, nearby, Effort::Full, counters, budget, progress);
  Eigen::VectorXd z =
      maps.injective ? *maps.injective : stubbornMap(problem, maps, Effort::Full, counters, budget, progress);
  optimize(problem, z, counters, progress);
  return z;
}

Parametrization exactMap(const SurfaceMesh& mesh, const SeamBasis& basis, const Eigen::VectorXd& z,
                         bool integer) {
  Parametrization map = roundedMap(mesh, basis, z);
  verify(map, integer);
  return map;
}

}  // namespace trimquad
