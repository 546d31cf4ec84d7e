#include "trimquad/embed/snap.h"

#include <algorithm>
#include <array>
#include <optional>

#include "trimquad/base/error.h"
#include "trimquad/mesh/collapse_edge.h"

namespace trimquad {
namespace {

/// Parts of an input triangle: smaller ones count as flat, unless the triangles before were no larger.
constexpr double kFlat = 1e-4, kDegenerate = 1e-10;

/// The cost is that of the vertices that the input has not: each is tried again only where something around
/// it has changed.
class Snapping {
 public:
  Snapping(const SurfaceMesh& input, RefinedMesh& refined, const std::vector<VertexHandle*>& nodes,
           const std::vector<EdgePath*>& paths)
      : input_(input),
        refined_(refined),
        mesh_(refined.mesh),
        nodes_(nodes),
        paths_(paths),
        place_(mesh_.n_vertices()),
        onPath_(mesh_.n_edges(), false),
        waiting_(mesh_.n_vertices(), false),
        metInRound_(mesh_.n_vertices(), 0) {
    for (std::size_t n = 0; n < nodes_.size(); ++n) place_[nodes_[n]->idx()].node = int(n);
    for (const EdgePath* path : paths_)
      for (std::size_t k = 1; k < path->size(); ++k) {
        onPath_[edgeBetween((*path)[k - 1], (*path)[k]).idx()] = true;
        if (k + 1 == path->size()) continue;
        place_[(*path)[k].idx()].inside = int(inside_.size());
        inside_.push_back((*path)[k]);
      }
    for (const EdgePath* path : paths_) ends_.push_back({nodeAt(path->front()), nodeAt(path->back())});
  }

  int run() {
    int count = 0;
    std::vector<VertexHandle> next;
    for (std::size_t i = input_.n_vertices(); i < mesh_.n_vertices(); ++i)
      if (!isGone(VertexHandle(int(i)))) next.push_back(VertexHandle(int(i)));
    while (!next.empty()) {
      for (const VertexHandle v : next) waiting_[v.idx()] = true;
      changed_.clear();
      for (const VertexHandle v : next) {
        waiting_[v.idx()] = false;
        if (!isGone(v) && collapseFrom(v)) ++count;
      }
      next.swap(changed_);
      std::erase_if(next, [&](VertexHandle v) { return isGone(v); });
      std::sort(next.begin(), next.end());
      next.erase(std::unique(next.begin(), next.end()), next.end());
    }
    if (count > 0) writePaths();
    return count;
  }

 private:
  /// What is at a vertex.
  struct Place {
    std::optional<int> node;    ///< in `nodes_`
    std::optional<int> inside;  ///< in `inside_`
    bool isFree() const { return !node && !inside; }
  };

  bool isGone(VertexHandle v) const { return mesh_.is_isolated(v); }

  EdgeHandle edgeBetween(VertexHandle a, VertexHandle b) const {
    const HalfedgeHandle h = halfedgeBetween(mesh_, a, b);
    TRIMQUAD_ASSERT(h.is_valid());
    return mesh_.edge_handle(h);
  }

  int nodeAt(VertexHandle v) const {
    TRIMQUAD_ASSERT(place_[v.idx()].node);
    return *place_[v.idx()].node;
  }

  bool isOnPath(HalfedgeHandle h) const { return onPath_[mesh_.edge_handle(h).idx()]; }

  /// Onto the nearest neighbour that can take it.
  bool collapseFrom(VertexHandle v) {
    ways_.clear();
    for (const auto h : mesh_.voh_range(v)) {
      const VertexHandle to = mesh_.to_vertex_handle(h);
      if (closureHolds(input_, refined_.vertexOrigin[v.idx()], refined_.vertexOrigin[to.idx()]))
        ways_.emplace_back((mesh_.point(to) - mesh_.point(v)).squaredNorm(), h);
    }
    std::sort(ways_.begin(), ways_.end());
    for (const auto& [length, h] : ways_)
      if (keepsArrangement(h) && keepsTopology(h) && keepsSurface(h)) {
        collapse(h);
        return true;
      }
    return false;
  }

  bool keepsArrangement(HalfedgeHandle h) const {
    const auto &here = place_[mesh_.from_vertex_handle(h).idx()],
               &there = place_[mesh_.to_vertex_handle(h).idx()];
    if (here.isFree() || there.isFree()) return true;
    if (!isOnPath(h) || (here.node && there.node)) return false;
    // No two paths may come to lie on each other.
    for (const HalfedgeHandle side : {h, mesh_.opposite_halfedge_handle(h)})
      if (!mesh_.is_boundary(side) && isOnPath(mesh_.next_halfedge_handle(side)) &&
          isOnPath(mesh_.prev_halfedge_handle(side)))
        return false;
    return true;
  }

  /// The link condition: what both ends are joined to are the tips of the triangles between them only. Its
  /// part about boundaries holds as vertices stay in the closure of their element.
  bool keepsTopology(HalfedgeHandle h) {
    ++round_;
    for (const auto w : mesh_.vv_range(mesh_.to_vertex_handle(h))) metInRound_[w.idx()] = round_;
    int common = 0;
    for (const auto w : mesh_.vv_range(mesh_.from_vertex_handle(h))) common += metInRound_[w.idx()] == round_;
    int tips = 0;
    VertexHandle tip;
    for (const HalfedgeHandle side : {h, mesh_.opposite_halfedge_handle(h)}) {
      if (mesh_.is_boundary(side)) continue;
      const VertexHandle here = mesh_.to_vertex_handle(mesh_.next_halfedge_handle(side));
      if (here == tip) return false;
      tip = here;
      ++tips;
    }
    return common == tips;
  }

  bool keepsSurface(HalfedgeHandle h) const {
    const VertexHandle v = mesh_.from_vertex_handle(h), to = mesh_.to_vertex_handle(h);
    const auto &before = refined_.vertexOrigin[v.idx()], &after = refined_.vertexOrigin[to.idx()];
    double leastAfter = 1;
    for (const auto out : mesh_.voh_range(v)) {
      if (mesh_.is_boundary(out)) continue;
      const VertexHandle a = mesh_.to_vertex_handle(out),
                         b = mesh_.to_vertex_handle(mesh_.next_halfedge_handle(out));
      if (a == to || b == to) continue;
      leastAfter = std::min(leastAfter, area(out, after, a, b));
      if (leastAfter <= kDegenerate) return false;
    }
    if (leastAfter > kFlat) return true;
    for (const auto out : mesh_.voh_range(v)) {
      if (mesh_.is_boundary(out)) continue;
      const VertexHandle a = mesh_.to_vertex_handle(out),
                         b = mesh_.to_vertex_handle(mesh_.next_halfedge_handle(out));
      if (area(out, before, a, b) <= leastAfter) return true;
    }
    return false;
  }

  /// Of the triangle of `out`, the vertex that this leaves at `place`, the others a and b.
  double area(HalfedgeHandle out, const RefinedMesh::Origin& place, VertexHandle a, VertexHandle b) const {
    return areaInOrigin(input_, refined_.originOf(mesh_.face_handle(out)), place,
                        refined_.vertexOrigin[a.idx()], refined_.vertexOrigin[b.idx()]);
  }

  void collapse(HalfedgeHandle h) {
    const VertexHandle v = mesh_.from_vertex_handle(h), to = mesh_.to_vertex_handle(h);
    takeOver(v, to);
    // Of each triangle that vanishes two sides become one.
    std::array<VertexHandle, 2> apex;
    bool taken[2] = {};
    for (const int k : {0, 1}) {
      const HalfedgeHandle side = k == 0 ? h : mesh_.opposite_halfedge_handle(h);
      if (mesh_.is_boundary(side)) continue;
      apex[k] = mesh_.to_vertex_handle(mesh_.next_halfedge_handle(side));
      taken[k] = isOnPath(mesh_.next_halfedge_handle(side)) || isOnPath(mesh_.prev_halfedge_handle(side));
    }
    collapseEdge(mesh_, h);
    for (const int k : {0, 1})
      if (apex[k].is_valid()) onPath_[edgeBetween(to, apex[k]).idx()] = taken[k];
    retry(to);
    for (const auto w : mesh_.vv_range(to)) retry(w);
  }

  /// What is around the vertex has changed.
  void retry(VertexHandle v) {
    if (std::size_t(v.idx()) >= input_.n_vertices() && !waiting_[v.idx()]) changed_.push_back(v);
  }

  /// What is at `v` moves to `to`, where it takes the place of the inside of a path.
  void takeOver(VertexHandle v, VertexHandle to) {
    Place &here = place_[v.idx()], &there = place_[to.idx()];
    if (here.isFree()) return;
    if (here.inside && there.isFree()) {
      inside_[*here.inside] = to;
      there.inside = here.inside;
    } else if (here.inside) {
      inside_[*here.inside] = VertexHandle();
    } else if (there.inside) {
      inside_[*there.inside] = VertexHandle();
      there.inside.reset();
    }
    if (here.node) {
      *nodes_[*here.node] = to;
      there.node = here.node;
    }
    here = {};
  }

  void writePaths() {
    auto inside = inside_.begin();
    for (std::size_t p = 0; p < paths_.size(); ++p) {
      EdgePath& path = *paths_[p];
      const std::size_t length = path.size();
      path.assign(1, *nodes_[ends_[p][0]]);
      for (std::size_t k = 2; k < length; ++k, ++inside)
        if (inside->is_valid()) path.push_back(*inside);
      path.push_back(*nodes_[ends_[p][1]]);
    }
  }

  const SurfaceMesh& input_;
  RefinedMesh& refined_;
  SurfaceMesh& mesh_;
  const std::vector<VertexHandle*> nodes_;
  const std::vector<EdgePath*> paths_;
  std::vector<std::array<int, 2>> ends_;  ///< by path, the nodes
  std::vector<VertexHandle> inside_;      ///< of the paths, one after the other; invalid where taken out
  std::vector<Place> place_;              ///< by vertex
  std::vector<bool> onPath_;              ///< by edge
  std::vector<bool> waiting_;             ///< by vertex: it will be tried in this round
  std::vector<VertexHandle> changed_;     ///< for the next round
  std::vector<int> metInRound_;           ///< by vertex, of `keepsTopology`
  int round_ = 0;
  std::vector<std::pair<double, HalfedgeHandle>> ways_;
};

}  // namespace

int snap(const SurfaceMesh& input, RefinedMesh& refined, const std::vector<VertexHandle*>& nodes,
         const std::vector<EdgePath*>& paths) {
  return Snapping(input, refined, nodes, paths).run();
}

}  // namespace trimquad
