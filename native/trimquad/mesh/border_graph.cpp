#include "trimquad/mesh/border_graph.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace trimquad {
namespace {

using Eigen::Vector3d;

/// Over how many edges to each side a turn is measured.
constexpr int kCornerReach = 4;

double angleBetween(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// The smallest turn at place i of a chain of points, over one to four edges; closed chains go on at the
/// other end and are measured over less than half of them.
double turn(const std::vector<Vector3d>& points, int i, bool closed) {
  const int n = int(points.size());
  const int reach = closed ? std::min(kCornerReach, (n - 1) / 2) : std::min({kCornerReach, i, n - 1 - i});
  double least = std::numeric_limits<double>::infinity();
  for (int k = 1; k <= std::max(1, reach); ++k) {
    const Vector3d &before = points[(i - k + n) % n], &here = points[i], &after = points[(i + k) % n];
    least = std::min(least, angleBetween(here - before, after - here));
  }
  return least;
}

/// Walks from halfedge to halfedge along border edges.
class BorderWalk {
 public:
  BorderWalk(const SurfaceMesh& mesh, const std::vector<bool>& border, const std::vector<bool>& corner)
      : mesh_(mesh), border_(border), corner_(corner) {}

  /// The border halfedge that goes on after `h`; none at a corner.
  std::optional<HalfedgeHandle> next(HalfedgeHandle h) const {
    const VertexHandle v = mesh_.to_vertex_handle(h);
    if (corner_[v.idx()]) return {};
    for (const auto o : mesh_.voh_range(v))
      if (border_[mesh_.edge_handle(o).idx()] && o != mesh_.opposite_halfedge_handle(h))
        return HalfedgeHandle(o);
    return {};
  }

  /// From `h` to the next corner, or around.
  std::vector<HalfedgeHandle> from(HalfedgeHandle h) const {
    std::vector<HalfedgeHandle> walk{h};
    for (auto following = next(h); following && *following != h; following = next(*following))
      walk.push_back(*following);
    return walk;
  }

 private:
  const SurfaceMesh& mesh_;
  const std::vector<bool>&border_, &corner_;
};

/// The halfedge of a border edge from which its chain is walked: the inner one on the boundary.
HalfedgeHandle walked(const SurfaceMesh& mesh, EdgeHandle e) {
  const auto h = mesh.halfedge_handle(e, 0);
  return mesh.is_boundary(h) ? mesh.opposite_halfedge_handle(h) : h;
}

/// All chains between the present corners.
std::vector<BorderChain> chainsBetween(const SurfaceMesh& mesh, const std::vector<bool>& border,
                                       const std::vector<bool>& corner) {
  const BorderWalk walk(mesh, border, corner);
  std::vector<bool> done(mesh.n_edges(), false);
  std::vector<BorderChain> chains;
  const auto take = [&](HalfedgeHandle start) {
    auto& chain = chains.emplace_back();
    chain.halfedges = walk.from(start);
    for (const auto h : chain.halfedges) done[mesh.edge_handle(h).idx()] = true;
  };
  for (const auto e : mesh.edges()) {
    if (!border[e.idx()] || done[e.idx()]) continue;
    // Back to the corner in which the chain of this edge starts, or around to this edge.
    const HalfedgeHandle back = mesh.opposite_halfedge_handle(walked(mesh, e));
    const auto backwards = walk.from(back);
    const bool closed = walk.next(backwards.back()).has_value();
    take(closed ? walked(mesh, e) : mesh.opposite_halfedge_handle(backwards.back()));
  }
  return chains;
}

}  // namespace

std::vector<int> partsBetween(const SurfaceMesh& mesh, const std::vector<bool>& wall) {
  std::vector<int> part(mesh.n_faces(), -1);
  for (const auto seed : mesh.faces()) {
    if (part[seed.idx()] >= 0) continue;
    std::vector<FaceHandle> queue{seed};
    part[seed.idx()] = seed.idx();
    for (std::size_t i = 0; i < queue.size(); ++i)
      for (const auto h : mesh.fh_range(queue[i])) {
        const FaceHandle g = mesh.opposite_face_handle(h);
        if (!g.is_valid() || part[g.idx()] >= 0 || wall[mesh.edge_handle(h).idx()]) continue;
        part[g.idx()] = seed.idx();
        queue.push_back(g);
      }
  }
  return part;
}

std::vector<bool> bordersBetween(const SurfaceMesh& mesh, const std::vector<int>& label) {
  std::vector<bool> border(mesh.n_edges());
  for (const auto e : mesh.edges()) {
    const auto h = mesh.halfedge_handle(e, 0);
    border[e.idx()] =
        mesh.is_boundary(e) || label[mesh.face_handle(h).idx()] != label[mesh.opposite_face_handle(h).idx()];
  }
  return border;
}

BorderGraph::BorderGraph(const SurfaceMesh& mesh, std::vector<bool> border, double cornerAngle)
    : border_(std::move(border)), corner_(mesh.n_vertices(), false) {
  std::vector<int> degree(mesh.n_vertices(), 0);
  for (const auto e : mesh.edges()) {
    if (!border_[e.idx()]) continue;
    const auto h = mesh.halfedge_handle(e, 0);
    ++degree[mesh.from_vertex_handle(h).idx()];
    ++degree[mesh.to_vertex_handle(h).idx()];
  }
  for (const auto v : mesh.vertices()) corner_[v.idx()] = degree[v.idx()] != 0 && degree[v.idx()] != 2;

  std::vector<bool> turning(mesh.n_vertices(), false);
  for (const auto& chain : chainsBetween(mesh, border_, corner_)) {
    std::vector<Vector3d> points;
    for (const auto h : chain.halfedges) points.push_back(mesh.point(mesh.from_vertex_handle(h)));
    const auto end = mesh.to_vertex_handle(chain.halfedges.back());
    const bool closed = end == mesh.from_vertex_handle(chain.halfedges.front()) && !corner_[end.idx()];
    if (!closed) points.push_back(mesh.point(end));
    bool found = false;
    for (int i = closed ? 0 : 1; i < int(chain.halfedges.size()); ++i) {
      if (!(turn(points, i, closed) > cornerAngle)) continue;
      turning[mesh.from_vertex_handle(chain.halfedges[i]).idx()] = true;
      found = true;
    }
    if (closed && !found) {
      const auto smallest =
          std::min_element(chain.halfedges.begin(), chain.halfedges.end(), [&](auto a, auto b) {
            return mesh.from_vertex_handle(a).idx() < mesh.from_vertex_handle(b).idx();
          });
      turning[mesh.from_vertex_handle(*smallest).idx()] = true;
    }
  }
  for (const auto v : mesh.vertices()) corner_[v.idx()] = corner_[v.idx()] || turning[v.idx()];
  chains_ = chainsBetween(mesh, border_, corner_);
}

}  // namespace trimquad
