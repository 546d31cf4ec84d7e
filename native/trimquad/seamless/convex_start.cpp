#include "trimquad/seamless/convex_start.h"

#include <cmath>
#include <numbers>

#include "trimquad/base/error.h"
#include "trimquad/base/sparse_solver.h"

namespace trimquad {
namespace {

double loopLength(const SurfaceMesh& mesh, const std::vector<HalfedgeHandle>& loop) {
  double length = 0;
  for (const auto h : loop) length += mesh.calc_edge_length(h);
  return length;
}

/// Crossings of the one seam branch, signed, along halfedge h seen as a step of a vertex's own coordinates:
/// stepping from the wedge of `h` in its face. Positions are kept per vertex in the chart of the vertex's
/// first wedge; `lift` tells, by halfedge, how many periods its wedge lies beyond that.
std::vector<int> wedgeLifts(const SurfaceMesh& mesh, const SeamGraph& seams) {
  std::vector<int> lift(mesh.n_halfedges(), 0);
  for (const auto v : mesh.vertices()) {
    // Start at the boundary where there is one, so that the walk meets every sector once.
    HalfedgeHandle start = mesh.halfedge_handle(v);
    if (mesh.is_boundary(v))
      for (const auto out : mesh.voh_range(v))
        if (mesh.is_boundary(mesh.opposite_halfedge_handle(out))) start = out;
    int periods = 0;
    HalfedgeHandle h = start;
    do {
      lift[h.idx()] = periods;
      const auto in = mesh.prev_halfedge_handle(h);
      if (const auto& crossing = seams.crossing[in.idx()]) periods += crossing->forward ? 1 : -1;
      h = mesh.opposite_halfedge_handle(in);
    } while (h != start && !mesh.is_boundary(h));
  }
  return lift;
}

}  // namespace

std::optional<Eigen::VectorXd> convexStart(const SurfaceMesh& mesh, const SeamGraph& seams,
                                           const SeamBasis& basis, double area,
                                           std::optional<double> period) {
  if (!seams.outerLoop && !seams.tube) return std::nullopt;
  const auto loops = boundaryLoops(mesh);
  const auto lift = wedgeLifts(mesh, seams);

  // Loops that are held: the outer one, or the two that the seam path joins.
  std::vector<int> loopOf(mesh.n_vertices(), -1);
  for (int l = 0; l < int(loops.size()); ++l)
    for (const auto h : loops[l]) loopOf[mesh.from_vertex_handle(h).idx()] = l;
  std::vector<int> held;
  if (period) {
    std::vector<int> around(loops.size(), 0);
    for (int l = 0; l < int(loops.size()); ++l)
      for (const auto h : loops[l]) {
        const auto v = mesh.from_vertex_handle(h);
        for (const auto out : mesh.voh_range(v)) {
          if (mesh.is_boundary(out)) continue;
          if (const auto& crossing = seams.crossing[mesh.prev_halfedge_handle(out).idx()])
            around[l] += crossing->forward ? 1 : -1;
        }
      }
    for (int l = 0; l < int(loops.size()); ++l)
      if (around[l] != 0) held.push_back(l);
    if (held.size() != 2) return std::nullopt;
    // Counter-clockwise around a vertex of the lower end (the surface above it) means against u.
    if (around[held[0]] > 0) std::swap(held[0], held[1]);
  } else {
    if (!seams.outerLoop) return std::nullopt;
    held.push_back(*seams.outerLoop);
  }

  const int vertices = int(mesh.n_vertices()), loopCount = int(loops.size());
  Eigen::MatrixX2d position = Eigen::MatrixX2d::Zero(vertices + loopCount, 2);
  std::vector<char> fixed(vertices + loopCount, 0);
  for (int end = 0; end < int(held.size()); ++end) {
    const auto& loop = loops[held[end]];
    fixed[vertices + held[end]] = 1;
    const double length = loopLength(mesh, loop);
    double walked = 0;
    if (!period) {
      const double radius = std::sqrt(area / std::numbers::pi);
      // The loop's halfedges have the surface on their right: clockwise.
      for (const auto h : loop) {
        const double a = -2 * std::numbers::pi * walked / length;
        position.row(mesh.from_vertex_handle(h).idx()) << radius * std::cos(a), radius * std::sin(a);
        fixed[mesh.from_vertex_handle(h).idx()] = 1;
        walked += mesh.calc_edge_length(h);
      }
      continue;
    }
    // Along an end of a tube, u runs from the seam's first wedge on; vertex positions are those of the first
    // wedge.
    const double height = area / std::abs(*period);
    const bool upper = end == 1;
    const double sense = upper ? 1 : -1;  // surface on the right: the upper end runs along u
    size_t first = 0;
    for (size_t i = 0; i < loop.size(); ++i) {
      const auto v = mesh.from_vertex_handle(loop[i]);
      for (const auto out : mesh.voh_range(v))
        if (!mesh.is_boundary(out) && seams.crossing[mesh.prev_halfedge_handle(out).idx()]) first = i;
    }
    double u = 0;
    for (size_t k = 0; k < loop.size(); ++k) {
      const auto h = loop[(first + k) % loop.size()];
      const auto v = mesh.from_vertex_handle(h);
      position.row(v.idx()) << u, (upper ? height : 0.0);
      fixed[v.idx()] = 1;
      // The inner halfedge of this boundary edge, and its two wedges' lifts, give the step to the next
      // vertex's own position.
      const auto inner = mesh.opposite_halfedge_handle(h);  // from next vertex to v
      const int liftNext = lift[inner.idx()], liftHere = lift[mesh.next_halfedge_handle(inner).idx()];
      u += sense * std::abs(*period) * mesh.calc_edge_length(h) / length + (liftHere - liftNext) * *period;
    }
  }

  std::vector<int> unknown(vertices + loopCount, -1);
  int count = 0;
  for (int i = 0; i < vertices + loopCount; ++i)
    if (!fixed[i]) unknown[i] = count++;
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixX2d rhs = Eigen::MatrixX2d::Zero(count, 2);
  const auto spring = [&](int i, int j, double shift) {  // position j + shift beside position i
    for (const auto& [a, b, s] : {std::tuple(i, j, shift), std::tuple(j, i, -shift)}) {
      if (unknown[a] < 0) continue;
      entries.emplace_back(unknown[a], unknown[a], 1.0);
      rhs(unknown[a], 0) += s;
      if (unknown[b] >= 0)
        entries.emplace_back(unknown[a], unknown[b], -1.0);
      else
        rhs.row(unknown[a]) += position.row(b);
    }
  };
  const double step = period.value_or(0.0);
  for (const auto e : mesh.edges()) {
    auto h = mesh.halfedge_handle(e, 0);
    if (mesh.is_boundary(h)) h = mesh.opposite_halfedge_handle(h);
    const auto a = mesh.from_vertex_handle(h), b = mesh.to_vertex_handle(h);
    // wedge(a) = position(a) + lift * period, and the same for b, in one face
    spring(a.idx(), b.idx(), (lift[mesh.next_halfedge_handle(h).idx()] - lift[h.idx()]) * step);
  }
  for (int l = 0; l < loopCount; ++l) {
    if (unknown[vertices + l] < 0) continue;
    int turns = 0;  // periods passed along the loop so far
    for (const auto h : loops[l]) {
      const auto v = mesh.from_vertex_handle(h);
      spring(vertices + l, v.idx(), turns * step);
      const auto inner = mesh.opposite_halfedge_handle(h);
      turns += lift[inner.idx()] - lift[mesh.next_halfedge_handle(inner).idx()];
    }
  }
  Eigen::SparseMatrix<double> matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  SparseSolver solver("seamless");
  solver.factorize(matrix);
  const Eigen::MatrixXd solution = solver.solve(rhs);
  for (int i = 0; i < vertices + loopCount; ++i)
    if (unknown[i] >= 0) position.row(i) = solution.row(unknown[i]);

  Eigen::VectorXd x = Eigen::VectorXd::Zero(basis.basis().variableCount());
  for (int b = 0; b < basis.branchCount(); ++b) x[basis.translation(b, 0)] = step;
  for (const auto h : mesh.halfedges()) {
    if (mesh.is_boundary(h)) continue;
    const Eigen::RowVector2d p = position.row(mesh.from_vertex_handle(h).idx());
    x[basis.coordinate(basis.wedge(h), 0)] = p.x() + lift[h.idx()] * step;
    x[basis.coordinate(basis.wedge(h), 1)] = p.y();
  }
  return x;
}

}  // namespace trimquad
