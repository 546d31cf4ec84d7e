#include <cmath>
#include <numbers>

#include "trimquad/base/error.h"
#include "trimquad/seamless/convex_start.h"
#include "trimquad/seamless/newton.h"
#include "trimquad/seamless/solve_map.h"

namespace trimquad {
namespace {

/// A plane region with its holes filled by a fan each and its outer loop surrounded by rings; positions in
/// the plane.
struct Scaffold {
  TriangleSoup soup;  // the region's triangles first; points are not used but for their number
  std::vector<Eigen::Vector2d> position;
  std::vector<int> outermost;  ///< vertices of the last ring
  /// The basis holds vertex 0 at the origin. That must be one of the outermost ring, which does not move
  /// anyway, so the region's vertex 0 and the first of the ring have changed numbers.
  int zero = 0;
  int number(int vertex) const { return vertex == 0 ? zero : vertex == zero ? 0 : vertex; }
};

std::array<int, 3> corners(const SurfaceMesh& mesh, FaceHandle f) {
  const auto h = mesh.halfedge_handle(f), n = mesh.next_halfedge_handle(h);
  return {mesh.from_vertex_handle(h).idx(), mesh.to_vertex_handle(h).idx(), mesh.to_vertex_handle(n).idx()};
}

Scaffold scaffold(const SurfaceMesh& mesh, int outer, std::vector<Eigen::Vector2d> position) {
  Scaffold result;
  for (const auto f : mesh.faces()) result.soup.triangles.push_back(corners(mesh, f));
  const auto loops = boundaryLoops(mesh);
  for (int l = 0; l < int(loops.size()); ++l) {
    const auto& loop = loops[l];
    if (l != outer) {
      const int centre = int(position.size());
      Eigen::Vector2d mean = Eigen::Vector2d::Zero();
      for (const auto h : loop) mean += position[mesh.from_vertex_handle(h).idx()] / double(loop.size());
      position.push_back(mean);
      for (const auto h : loop)
        result.soup.triangles.push_back(
            {mesh.from_vertex_handle(h).idx(), mesh.to_vertex_handle(h).idx(), centre});
      continue;
    }
    // Rings of ever larger triangles around the circle on which the outer loop lies.
    const int n = int(loop.size());
    std::vector<int> ring(n);
    for (int i = 0; i < n; ++i) ring[i] = mesh.from_vertex_handle(loop[i]).idx();
    for (const double growth : {1.15, 1.3, 1.5, 1.8}) {
      std::vector<int> next(n);
      for (int i = 0; i < n; ++i) {
        next[i] = int(position.size());
        const Eigen::Vector2d p = growth * position[ring[i]];
        position.push_back(p);
      }
      for (int i = 0; i < n; ++i) {
        const int j = (i + 1) % n;
        result.soup.triangles.push_back({ring[i], ring[j], next[j]});
        result.soup.triangles.push_back({ring[i], next[j], next[i]});
      }
      ring = next;
    }
    result.outermost = ring;
  }
  result.zero = result.outermost.front();
  for (auto& triangle : result.soup.triangles)
    for (int& v : triangle) v = result.number(v);
  for (int& v : result.outermost) v = result.number(v);
  std::swap(position[0], position[result.zero]);
  result.position = std::move(position);
  for (const auto& p : result.position) result.soup.points.emplace_back(p.x(), p.y(), 0);
  return result;
}

}  // namespace

Eigen::VectorXd oneToOneMap(const SurfaceMesh& mesh, const SeamGraph& seams, const MapTarget& target,
                            const SeamBasis& basis, double follow, MapCounters& counters,
                            const Progress& progress) {
  TRIMQUAD_ASSERT(basis.branchCount() == 0);
  double area = 0;
  for (const auto& t : target) {
    const Eigen::Vector2d a = t[1] - t[0], b = t[2] - t[0];
    area += (a.x() * b.y() - a.y() * b.x()) / 2;
  }
  const auto start = convexStart(mesh, seams, basis, area, std::nullopt);
  TRIMQUAD_ASSERT(start.has_value());
  std::vector<Eigen::Vector2d> position(mesh.n_vertices());
  for (const auto h : mesh.halfedges())
    if (!mesh.is_boundary(h))
      for (int axis = 0; axis < 2; ++axis)
        position[mesh.from_vertex_handle(h).idx()][axis] = (*start)[basis.coordinate(basis.wedge(h), axis)];
  const Scaffold frame = scaffold(mesh, *seams.outerLoop, position);
  const SurfaceMesh extended = buildSurfaceMesh(frame.soup);
  SeamGraph none;
  none.crossing.resize(extended.n_halfedges());
  const SeamBasis extendedBasis(extended, none, {});

  Eigen::VectorXd x(extendedBasis.basis().variableCount());
  const auto coordinate = [&](HalfedgeHandle h, int axis) {
    return extendedBasis.coordinate(extendedBasis.wedge(h), axis);
  };
  const auto holdOrigin = [&](Eigen::VectorXd& y) {
    const Eigen::Vector2d origin(y[extendedBasis.coordinate(0, 0)], y[extendedBasis.coordinate(0, 1)]);
    for (int w = 0; w < extendedBasis.wedgeCount(); ++w)
      for (int axis = 0; axis < 2; ++axis) y[extendedBasis.coordinate(w, axis)] -= origin[axis];
  };
  for (const auto h : extended.halfedges())
    if (!extended.is_boundary(h))
      for (int axis = 0; axis < 2; ++axis)
        x[coordinate(h, axis)] = frame.position[extended.from_vertex_handle(h).idx()][axis];
  holdOrigin(x);
  Eigen::VectorXd z = extendedBasis.basis().restrict(x);

  // The outermost ring stays convex, so that the whole is one to one as long as no triangle is turned over.
  std::vector<char> isOutermost(extended.n_vertices(), 0);
  for (const int v : frame.outermost) isOutermost[v] = 1;
  std::vector<char> isHeld(extendedBasis.basis().variableCount(), 0);
  for (const auto h : extended.halfedges())
    if (!extended.is_boundary(h) && isOutermost[extended.from_vertex_handle(h).idx()])
      for (int axis = 0; axis < 2; ++axis) isHeld[coordinate(h, axis)] = 1;
  std::vector<int> held;
  for (int i = 0; i < extendedBasis.basis().freeCount(); ++i)
    if (isHeld[extendedBasis.basis().freeVariable(i)]) held.push_back(i);

  // The scaffold's target is its present shape, renewed every few steps, so that it yields but never folds.
  SparseSolver solver("seamless");
  const int regionFaces = int(mesh.n_faces());
  constexpr int kRounds = 100, kStepsPerRound = 4;
  constexpr double kScaffoldWeight = 1e-2;  // of the region's energy, for the scaffold as a whole
  double previous = INFINITY;
  int stalled = 0;
  for (int round = 0; round < kRounds; ++round) {
    x = extendedBasis.basis().matrix() * z + extendedBasis.basis().offset();
    MapTarget extendedTarget = target;
    for (const auto f : extended.faces()) {
      if (f.idx() < regionFaces) continue;
      auto& corner = extendedTarget.emplace_back();
      HalfedgeHandle h = extended.halfedge_handle(f);
      for (int k = 0; k < 3; ++k, h = extended.next_halfedge_handle(h))
        corner[k] = {x[coordinate(h, 0)], x[coordinate(h, 1)]};
    }
    MapEnergy energy(extended, extendedTarget, extendedBasis);
    energy.setScaffold(regionFaces, 0);
    const double regionEnergy = energy.value(x, symmetricDirichlet, follow);
    energy.setScaffold(regionFaces,
                       kScaffoldWeight * regionEnergy / (4.0 * double(extended.n_faces() - regionFaces)));
    stalled = regionEnergy > previous * (1 - 2e-3) ? stalled + 1 : 0;
    if (stalled == 3) break;
    previous = regionEnergy;
    if (round == 0 && energy.flipped(x) > 0)
      throw stageError("seamless",
                       "a convex embedding of the region is too narrow for floating point; refine the mesh");
    for (int step = 0; step < kStepsPerRound; ++step) {
      newtonStep(energy, symmetricDirichlet, follow, true, solver, z, held);
      ++counters.iterations;
      progress.report(0.5 + 0.5 * (round * kStepsPerRound + step) / (kRounds * kStepsPerRound));
    }
  }
  x = extendedBasis.basis().matrix() * z + extendedBasis.basis().offset();
  Eigen::VectorXd mine(basis.basis().variableCount());
  for (const auto f : mesh.faces()) {
    HalfedgeHandle h = mesh.halfedge_handle(f), e = extended.halfedge_handle(f);
    while (extended.from_vertex_handle(e).idx() != frame.number(mesh.from_vertex_handle(h).idx()))
      e = extended.next_halfedge_handle(e);
    for (int k = 0; k < 3; ++k, h = mesh.next_halfedge_handle(h), e = extended.next_halfedge_handle(e))
      for (int axis = 0; axis < 2; ++axis)
        mine[basis.coordinate(basis.wedge(h), axis)] = x[coordinate(e, axis)];
  }
  const Eigen::Vector2d origin(mine[basis.coordinate(0, 0)], mine[basis.coordinate(0, 1)]);
  for (int w = 0; w < basis.wedgeCount(); ++w)
    for (int axis = 0; axis < 2; ++axis) mine[basis.coordinate(w, axis)] -= origin[axis];
  const MapEnergy energy(mesh, target, basis);
  counters.distortionEnd = energy.meanSymmetricDirichlet(mine);
  return basis.basis().restrict(mine);
}

}  // namespace trimquad
