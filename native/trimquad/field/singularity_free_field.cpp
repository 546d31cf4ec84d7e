#include "trimquad/field/singularity_free_field.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "trimquad/base/error.h"
#include "trimquad/field/angle.h"
#include "trimquad/field/angle_solve.h"
#include "trimquad/field/loop_turning.h"
#include "trimquad/field/transport.h"

namespace trimquad {
namespace {

/// One angle per face that the field should follow up to quarter turns, with a weight in [0, 1].
struct AngleGuidance {
  std::vector<double> angle;
  const std::vector<double>& weight;
};

AngleGuidance angles(const SurfaceMesh& mesh, const FieldGuidance& guidance, const Transport& transport) {
  AngleGuidance result{std::vector<double>(mesh.n_faces(), 0.0), guidance.weight};
  for (const auto f : mesh.faces())
    if (guidance.weight[f.idx()] > 0)
      result.angle[f.idx()] = transport.angleOf(f, guidance.direction[f.idx()]);
  return result;
}

/// Per edge (halfedge 0) how many full turns the field makes against parallel transport.
std::vector<int> jumps(const SurfaceMesh& mesh, const LoopTurning& turning,
                       const std::vector<int>& generator) {
  std::vector<int> jump(mesh.n_edges(), 0);
  for (size_t g = 0; g < generator.size(); ++g)
    for (const auto h : turning.paths[g])
      jump[mesh.edge_handle(h).idx()] +=
          (h == mesh.halfedge_handle(mesh.edge_handle(h), 0) ? 1 : -1) * generator[g];
  return jump;
}

/// The turns of the loops for which the smoothest field is smoothest of all: -1 for every loop but two ends
/// of a tube (0 each), or but one outer loop (+1). Others need seams with rotations or dislocations.
std::vector<int> smoothestTurning(const SurfaceMesh& mesh, const AngleSolve& solve,
                                  const std::vector<double>& base, const LoopTurning& turning) {
  const int loops = int(turning.loops.size());
  if (loops == 1) return {1};
  // The energy is quadratic in the generators' turns: one solution for each, and their Gram matrix.
  std::vector<Eigen::VectorXd> residuals;
  residuals.push_back(solve.residual(solve.solve(solve.rightHandSide(base)), base));
  for (int g = 0; g + 1 < loops; ++g) {
    std::vector<int> unit(loops - 1, 0);
    unit[g] = 1;
    const auto jump = jumps(mesh, turning, unit);
    std::vector<double> difference(jump.size());
    for (size_t e = 0; e < jump.size(); ++e) difference[e] = 2 * std::numbers::pi * jump[e];
    residuals.push_back(solve.residual(solve.solve(solve.rightHandSide(difference)), difference));
  }
  Eigen::MatrixXd gram(loops, loops);
  for (int i = 0; i < loops; ++i)
    for (int j = 0; j < loops; ++j) gram(i, j) = residuals[i].dot(residuals[j]);

  std::vector<int> best;
  double least = INFINITY;
  for (int a = 0; a < loops; ++a)
    for (int b = a; b < loops; ++b) {
      std::vector<int> wanted(loops, -1);
      ++wanted[a];
      ++wanted[b];
      const auto generator = generatorTurns(turning, wanted);
      Eigen::VectorXd x(loops);
      x[0] = 1;
      for (int g = 0; g + 1 < loops; ++g) x[g + 1] = generator[g];
      const double energy = x.dot(gram * x);
      if (energy < least * (1 - 1e-9)) least = energy, best = wanted;
    }
  return best;
}

/// The rotation, up to quarter turns, that brings `angle` closest to the guidance; and how sure it is, in [0,
/// 1].
std::pair<double, double> bestRotation(const SurfaceMesh& mesh, const AngleGuidance& guidance,
                                       const Eigen::VectorXd& angle) {
  std::complex<double> sum = 0;
  double total = 0;
  for (const auto f : mesh.faces()) {
    const double area = mesh.calc_face_area(f);
    sum += area * guidance.weight[f.idx()] * std::polar(1.0, 4 * (guidance.angle[f.idx()] - angle[f.idx()]));
    total += area;
  }
  return {std::arg(sum) / 4, std::abs(sum) / total};
}

/// The same from the directions of the boundary edges, for surfaces that bend nowhere.
double rotationAlongBoundary(const SurfaceMesh& mesh, const Transport& transport,
                             const Eigen::VectorXd& angle) {
  std::complex<double> sum = 0;
  for (const auto h : mesh.halfedges()) {
    if (!mesh.is_boundary(h)) continue;
    const auto f = mesh.opposite_face_handle(h);
    const Eigen::Vector3d d = mesh.point(mesh.to_vertex_handle(h)) - mesh.point(mesh.from_vertex_handle(h));
    sum += d.norm() * std::polar(1.0, 4 * (transport.angleOf(f, d) - angle[f.idx()]));
  }
  return std::arg(sum) / 4;
}

}  // namespace

bool admitsNoSingularity(const SurfaceMesh& mesh) {
  const auto loops = boundaryLoops(mesh);
  return !loops.empty() && 2 - eulerCharacteristic(mesh) == int(loops.size());
}

CrossField singularityFreeField(const SurfaceMesh& mesh, const FieldGuidance& directions,
                                double guidanceReach, const Progress& progress) {
  const Transport frames = liftedTransport(mesh);
  const LoopTurning turning = loopTurning(mesh, frames);
  progress.report(0.2);

  AngleSolve solve(mesh);
  solve.factorize(std::vector<double>(mesh.n_faces(), 0.0));
  auto difference = transported(mesh, frames);
  const auto wanted = smoothestTurning(mesh, solve, difference, turning);
  const auto jump = jumps(mesh, turning, generatorTurns(turning, wanted));
  for (size_t e = 0; e < jump.size(); ++e) difference[e] += 2 * std::numbers::pi * jump[e];
  const Eigen::VectorXd smooth = solve.rightHandSide(difference);
  Eigen::VectorXd angle = solve.solve(smooth);
  progress.report(0.5);

  // The guidance settles the rotation that the smoothest field leaves open, then bends the field within its
  // homotopy class: the branch of the guidance nearest to the field is chosen anew a few times.
  const AngleGuidance guidance = angles(mesh, directions, frames);
  progress.report(0.7);
  const auto [rotation, certainty] = bestRotation(mesh, guidance, angle);
  angle.array() += certainty > 1e-3 ? rotation : rotationAlongBoundary(mesh, frames, angle);
  std::vector<double> weight(mesh.n_faces());
  const double area = surfaceArea(mesh);
  double totalWeight = 0;
  for (const auto f : mesh.faces()) {
    weight[f.idx()] =
        guidanceReach * guidanceReach * mesh.calc_face_area(f) / area * guidance.weight[f.idx()];
    totalWeight += weight[f.idx()];
  }
  if (certainty > 1e-3 && totalWeight > 0) {
    solve.factorize(weight);
    constexpr int kRounds = 6;
    for (int round = 0; round < kRounds; ++round) {
      Eigen::VectorXd rhs = smooth;
      for (const auto f : mesh.faces()) {
        const double off = guidance.angle[f.idx()] - angle[f.idx()];
        rhs[f.idx()] +=
            weight[f.idx()] * (angle[f.idx()] + off - kQuarterTurn * std::round(off / kQuarterTurn));
      }
      angle = solve.solve(rhs);
      progress.report(0.7 + 0.3 * (round + 1) / kRounds);
    }
  }

  CrossField field;
  field.direction.resize(mesh.n_faces());
  for (const auto f : mesh.faces()) field.direction[f.idx()] = frames.direction(f, angle[f.idx()]);
  field.matching.assign(mesh.n_halfedges(), 0);  // all jumps are full turns
  field.index.assign(mesh.n_vertices(), 0);
  for (const int turns : wanted) field.loopTurns.push_back(4 * turns);
  return field;
}

}  // namespace trimquad
