#include "trimquad/field/cross_field.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "trimquad/base/error.h"
#include "trimquad/base/sparse_solver.h"
#include "trimquad/field/loop_turning.h"
#include "trimquad/field/transport.h"
#include "trimquad/mesh/triangle_surface.h"

namespace trimquad {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kQuarter = kPi / 2;

/// One direction per face that the field should follow up to quarter turns, with a weight in [0, 1].
struct Guidance {
  std::vector<double> angle, weight;
};

/// The quadratic energy of a field given by one angle per face: sum of w (a_g - a_f - angle - jump)^2 over
/// the interior edges, and its solutions.
class AngleSolve {
 public:
  AngleSolve(const SurfaceMesh& mesh, const Transport& transport) : mesh_(mesh), transport_(transport) {
    weight_.assign(mesh.n_edges(), 0.0);
    for (const auto e : mesh.edges()) {
      if (mesh.is_boundary(e)) continue;
      // primal over dual length, with the dual length from the areas beside the edge
      const double length2 = (mesh.point(mesh.to_vertex_handle(mesh.halfedge_handle(e, 0))) -
                              mesh.point(mesh.to_vertex_handle(mesh.halfedge_handle(e, 1))))
                                 .squaredNorm();
      const double area = faceArea(mesh.face_handle(mesh.halfedge_handle(e, 0))) +
                          faceArea(mesh.face_handle(mesh.halfedge_handle(e, 1)));
      weight_[e.idx()] = std::min(1.5 * length2 / area, 100.0);
    }
  }

  double faceArea(FaceHandle f) const {
    const auto h = mesh_.halfedge_handle(f);
    const Eigen::Vector3d a = mesh_.point(mesh_.from_vertex_handle(h)),
                          b = mesh_.point(mesh_.to_vertex_handle(h)),
                          c = mesh_.point(mesh_.to_vertex_handle(mesh_.next_halfedge_handle(h)));
    return 0.5 * (b - a).cross(c - a).norm();
  }

  /// Factorises the energy plus sum of faceWeight a_f^2 (with face 0 held where there is no weight at all).
  void factorize(const std::vector<double>& faceWeight) {
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(4 * mesh_.n_edges());
    double sum = 0;
    for (const double w : faceWeight) sum += w;
    for (const auto f : mesh_.faces()) entries.emplace_back(f.idx(), f.idx(), faceWeight[f.idx()]);
    if (sum == 0) entries.emplace_back(0, 0, 1.0);
    for (const auto e : mesh_.edges()) {
      if (mesh_.is_boundary(e)) continue;
      const int f = mesh_.face_handle(mesh_.halfedge_handle(e, 0)).idx(),
                g = mesh_.face_handle(mesh_.halfedge_handle(e, 1)).idx();
      const double w = weight_[e.idx()];
      entries.emplace_back(f, f, w);
      entries.emplace_back(g, g, w);
      entries.emplace_back(f, g, -w);
      entries.emplace_back(g, f, -w);
    }
    Eigen::SparseMatrix<double> matrix(Eigen::Index(mesh_.n_faces()), Eigen::Index(mesh_.n_faces()));
    matrix.setFromTriplets(entries.begin(), entries.end());
    solver_.factorize(matrix);
  }

  /// Right-hand side of prescribed differences (by halfedge 0 of each edge: what a_g - a_f should be).
  Eigen::VectorXd rightHandSide(const std::vector<double>& difference) const {
    Eigen::VectorXd rhs = Eigen::VectorXd::Zero(Eigen::Index(mesh_.n_faces()));
    for (const auto e : mesh_.edges()) {
      if (mesh_.is_boundary(e)) continue;
      const double flow = weight_[e.idx()] * difference[e.idx()];
      rhs[mesh_.face_handle(mesh_.halfedge_handle(e, 0)).idx()] -= flow;
      rhs[mesh_.face_handle(mesh_.halfedge_handle(e, 1)).idx()] += flow;
    }
    return rhs;
  }

  Eigen::VectorXd solve(const Eigen::VectorXd& rhs) const { return solver_.solve(rhs); }

  /// sqrt(w) (a_g - a_f - difference) per edge.
  Eigen::VectorXd residual(const Eigen::VectorXd& angle, const std::vector<double>& difference) const {
    Eigen::VectorXd r = Eigen::VectorXd::Zero(Eigen::Index(mesh_.n_edges()));
    for (const auto e : mesh_.edges()) {
      if (mesh_.is_boundary(e)) continue;
      const int f = mesh_.face_handle(mesh_.halfedge_handle(e, 0)).idx(),
                g = mesh_.face_handle(mesh_.halfedge_handle(e, 1)).idx();
      r[e.idx()] = std::sqrt(weight_[e.idx()]) * (angle[g] - angle[f] - difference[e.idx()]);
    }
    return r;
  }

  std::vector<double> transported() const {
    std::vector<double> difference(mesh_.n_edges(), 0.0);
    for (const auto e : mesh_.edges())
      difference[e.idx()] = transport_.angle[mesh_.halfedge_handle(e, 0).idx()];
    return difference;
  }

 private:
  const SurfaceMesh& mesh_;
  const Transport& transport_;
  std::vector<double> weight_;
  SparseSolver solver_{"field"};
};

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
                                  const LoopTurning& turning) {
  const int loops = int(turning.loops.size());
  if (loops == 1) return {1};
  // The energy is quadratic in the generators' turns: one solution for each, and their Gram matrix.
  std::vector<Eigen::VectorXd> residuals;
  const auto base = solve.transported();
  residuals.push_back(solve.residual(solve.solve(solve.rightHandSide(base)), base));
  for (int g = 0; g + 1 < loops; ++g) {
    std::vector<int> unit(loops - 1, 0);
    unit[g] = 1;
    const auto jump = jumps(mesh, turning, unit);
    std::vector<double> difference(jump.size());
    for (size_t e = 0; e < jump.size(); ++e) difference[e] = 2 * kPi * jump[e];
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

Guidance curvatureGuidance(const Region& region, const Transport& transport, const Progress& progress) {
  const auto& mesh = region.mesh;
  Guidance guidance;
  guidance.angle.resize(mesh.n_faces());
  guidance.weight.resize(mesh.n_faces());
  const std::shared_ptr<const TrueSurface> surface =
      region.surface ? region.surface : std::make_shared<TriangleSurface>(mesh);
  const double size = std::sqrt(surfaceArea(mesh));
  for (const auto f : mesh.faces()) {
    if (f.idx() % 1024 == 0) progress.check();
    const Eigen::Vector3d centroid = mesh.calc_face_centroid(f);
    const auto curvature = surface->curvature(centroid);
    guidance.angle[f.idx()] = transport.angleOf(f, curvature.direction1);
    // How distinct the directions are: the angle by which the surface bends more in one than in the other
    // over the region's size, against one radian.
    const double bend = std::abs(curvature.k1 - curvature.k2) * size;
    guidance.weight[f.idx()] = std::isfinite(bend) ? bend * bend / (1 + bend * bend) : 0.0;
  }
  return guidance;
}

/// The rotation, up to quarter turns, that brings `angle` closest to the guidance; and how sure it is, in [0,
/// 1].
std::pair<double, double> bestRotation(const SurfaceMesh& mesh, const AngleSolve& solve,
                                       const Guidance& guidance, const Eigen::VectorXd& angle) {
  std::complex<double> sum = 0;
  double total = 0;
  for (const auto f : mesh.faces()) {
    const double area = solve.faceArea(f);
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

/// Directions in a triangle need one.
void requireArea(const SurfaceMesh& mesh) {
  for (const auto f : mesh.faces()) {
    double longest = 0;
    for (const auto h : mesh.fh_range(f)) longest = std::max(longest, mesh.calc_edge_sqr_length(h));
    const auto h = mesh.halfedge_handle(f);
    const Eigen::Vector3d a = mesh.calc_edge_vector(h),
                          b = mesh.calc_edge_vector(mesh.next_halfedge_handle(h));
    if (!(a.cross(b).norm() > 1e-10 * longest))
      throw stageError("field",
                       "a triangle has no area; use a smaller edge length, or repair the shape there",
                       "triangle " + std::to_string(f.idx()), mesh.calc_face_centroid(f));
  }
}

void requireSingularityFree(const SurfaceMesh& mesh) {
  const auto loops = boundaryLoops(mesh);
  const int genus2 = 2 - eulerCharacteristic(mesh) - int(loops.size());
  if (loops.empty())
    throw stageError(
        "field",
        "the region is a closed surface, which needs irregular vertices; this version maps only regions "
        "with a boundary: cut it, or open it along an edge");
  if (genus2 != 0)
    throw stageError(
        "field",
        "the region has handles (genus " + std::to_string(genus2 / 2) +
            "), which need irregular vertices; this version maps only regions of genus 0: cut the handles");
}

}  // namespace

CrossField crossField(const Region& region, const Progress& progress) {
  const auto& mesh = region.mesh;
  requireSingularityFree(mesh);
  requireArea(mesh);
  const Transport frames = transport(mesh);
  const LoopTurning turning = loopTurning(mesh, frames);
  progress.report(0.2);

  AngleSolve solve(mesh, frames);
  solve.factorize(std::vector<double>(mesh.n_faces(), 0.0));
  const auto wanted = smoothestTurning(mesh, solve, turning);
  const auto jump = jumps(mesh, turning, generatorTurns(turning, wanted));
  auto difference = solve.transported();
  for (size_t e = 0; e < jump.size(); ++e) difference[e] += 2 * kPi * jump[e];
  const Eigen::VectorXd smooth = solve.rightHandSide(difference);
  Eigen::VectorXd angle = solve.solve(smooth);
  progress.report(0.5);

  // Curvature settles the rotation that the smoothest field leaves open, then bends the field within its
  // homotopy class: the branch of the guidance nearest to the field is chosen anew a few times.
  const Guidance guidance = curvatureGuidance(region, frames, progress);
  progress.report(0.7);
  const auto [rotation, certainty] = bestRotation(mesh, solve, guidance, angle);
  angle.array() += certainty > 1e-3 ? rotation : rotationAlongBoundary(mesh, frames, angle);
  constexpr double kGuidanceReach =
      4;  // the guidance takes over at lengths above 1 / (this) of the region's size
  std::vector<double> weight(mesh.n_faces());
  const double area = surfaceArea(mesh);
  double totalWeight = 0;
  for (const auto f : mesh.faces()) {
    weight[f.idx()] = kGuidanceReach * kGuidanceReach * solve.faceArea(f) / area * guidance.weight[f.idx()];
    totalWeight += weight[f.idx()];
  }
  if (certainty > 1e-3 && totalWeight > 0) {
    solve.factorize(weight);
    constexpr int kRounds = 6;
    for (int round = 0; round < kRounds; ++round) {
      Eigen::VectorXd rhs = smooth;
      for (const auto f : mesh.faces()) {
        const double off = guidance.angle[f.idx()] - angle[f.idx()];
        rhs[f.idx()] += weight[f.idx()] * (angle[f.idx()] + off - kQuarter * std::round(off / kQuarter));
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
  field.loopTurns = wanted;
  return field;
}

}  // namespace trimquad
