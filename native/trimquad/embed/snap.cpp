#include "trimquad/embed/snap.h"

#include <algorithm>
#include <optional>
#include <set>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

/// Parts of an input triangle: smaller ones count as flat, unless the triangles before were no larger.
constexpr double kFlat = 1e-4, kDegenerate = 1e-10;

class Snapping {
 public:
  Snapping(const SurfaceMesh& input, RefinedMesh& refined, std::vector<VertexHandle*> nodes,
           std::vector<EdgePath*> paths)
      : input_(input),
        refined_(refined),
        mesh_(refined.mesh),
        nodes_(std::move(nodes)),
        paths_(std::move(paths)) {
    nodeAt_.resize(mesh_.n_vertices());
    pathsAt_.resize(mesh_.n_vertices());
    for (std::size_t n = 0; n < nodes_.size(); ++n) nodeAt_[nodes_[n]->idx()] = n;
    for (std::size_t p = 0; p < paths_.size(); ++p) {
      const EdgePath& path = *paths_[p];
      for (std::size_t k = 0; k < path.size(); ++k) {
        if (k == 0 || path[k] != path.front()) pathsAt_[path[k].idx()].push_back(p);
        if (k > 0) onPath_.insert(ordered(path[k - 1], path[k]));
      }
    }
  }

  int run() {
    int count = 0;
    for (bool changed = true; changed;) {
      changed = false;
      for (std::size_t i = input_.n_vertices(); i < mesh_.n_vertices(); ++i) {
        const VertexHandle v{int(i)};
        if (mesh_.status(v).deleted() || !collapseFrom(v)) continue;
        changed = true, ++count;
      }
    }
    if (count == 0) return 0;
    const auto renamed = compact(refined_);
    for (VertexHandle* node : nodes_) *node = renamed[node->idx()];
    for (EdgePath* path : paths_)
      for (VertexHandle& v : *path) v = renamed[v.idx()];
    return count;
  }

 private:
  using Ends = std::pair<VertexHandle, VertexHandle>;
  static Ends ordered(VertexHandle a, VertexHandle b) { return a < b ? Ends{a, b} : Ends{b, a}; }
  bool onPath(VertexHandle a, VertexHandle b) const { return onPath_.contains(ordered(a, b)); }
  bool occupied(VertexHandle v) const { return nodeAt_[v.idx()] || !pathsAt_[v.idx()].empty(); }

  /// Onto the nearest neighbour that can take it.
  bool collapseFrom(VertexHandle v) {
    std::vector<std::pair<double, HalfedgeHandle>> ways;
    for (const auto h : mesh_.voh_range(v))
      ways.emplace_back((mesh_.point(mesh_.to_vertex_handle(h)) - mesh_.point(v)).squaredNorm(), h);
    std::sort(ways.begin(), ways.end());
    for (const auto& [length, h] : ways)
      if (keepsArrangement(h) && keepsSurface(h) && mesh_.is_collapse_ok(h)) {
        collapse(h);
        return true;
      }
    return false;
  }

  bool keepsArrangement(HalfedgeHandle h) const {
    const VertexHandle v = mesh_.from_vertex_handle(h), to = mesh_.to_vertex_handle(h);
    if (!occupied(v) || !occupied(to)) return true;
    if (!onPath(v, to) || (nodeAt_[v.idx()] && nodeAt_[to.idx()])) return false;
    for (const HalfedgeHandle side : {h, mesh_.opposite_halfedge_handle(h)}) {
      if (mesh_.is_boundary(side)) continue;
      const VertexHandle apex = mesh_.to_vertex_handle(mesh_.next_halfedge_handle(side));
      if (onPath(v, apex) && onPath(to, apex)) return false;
    }
    for (const std::size_t p : pathsAt_[v.idx()]) {
      const EdgePath& path = *paths_[p];
      if (path.size() == 2 && ordered(path[0], path[1]) == ordered(v, to)) return false;
    }
    return true;
  }

  bool keepsSurface(HalfedgeHandle h) const {
    const VertexHandle v = mesh_.from_vertex_handle(h), to = mesh_.to_vertex_handle(h);
    const auto &before = refined_.vertexOrigin[v.idx()], &after = refined_.vertexOrigin[to.idx()];
    if (!closureHolds(input_, before, after)) return false;
    double least = 1, leastAfter = 1;
    for (const auto f : mesh_.vf_range(v)) {
      const RefinedMesh::Origin *was[3], *is[3];
      bool vanishes = false;
      int k = 0;
      for (const auto corner : mesh_.fv_range(f)) {
        vanishes = vanishes || corner == to;
        was[k] = &refined_.vertexOrigin[corner.idx()];
        is[k] = corner == v ? &after : was[k];
        ++k;
      }
      const FaceHandle origin = refined_.originOf(f);
      least = std::min(least, areaInOrigin(input_, origin, *was[0], *was[1], *was[2]));
      if (!vanishes) leastAfter = std::min(leastAfter, areaInOrigin(input_, origin, *is[0], *is[1], *is[2]));
    }
    return leastAfter > kFlat || (leastAfter > kDegenerate && leastAfter >= least);
  }

  void collapse(HalfedgeHandle h) {
    const VertexHandle v = mesh_.from_vertex_handle(h), to = mesh_.to_vertex_handle(h);
    auto& here = pathsAt_[v.idx()];
    for (const std::size_t p : here) {
      EdgePath& path = *paths_[p];
      for (std::size_t k = 0; k + 1 < path.size(); ++k)
        if (path[k] == v || path[k + 1] == v) onPath_.erase(ordered(path[k], path[k + 1]));
      std::replace(path.begin(), path.end(), v, to);
      path.erase(std::unique(path.begin(), path.end()), path.end());
      for (std::size_t k = 0; k + 1 < path.size(); ++k)
        if (path[k] == to || path[k + 1] == to) onPath_.insert(ordered(path[k], path[k + 1]));
      auto& there = pathsAt_[to.idx()];
      if (std::find(there.begin(), there.end(), p) == there.end()) there.push_back(p);
    }
    here.clear();
    if (auto& node = nodeAt_[v.idx()]) {
      nodeAt_[to.idx()] = node;
      *nodes_[*node] = to;
      node.reset();
    }
    mesh_.collapse(h);
  }

  const SurfaceMesh& input_;
  RefinedMesh& refined_;
  SurfaceMesh& mesh_;
  std::vector<VertexHandle*> nodes_;
  std::vector<EdgePath*> paths_;
  std::vector<std::optional<std::size_t>> nodeAt_;  ///< by vertex
  std::vector<std::vector<std::size_t>> pathsAt_;   ///< by vertex
  std::set<Ends> onPath_;
};

}  // namespace

int snap(const SurfaceMesh& input, RefinedMesh& refined, std::vector<VertexHandle*> nodes,
         std::vector<EdgePath*> paths) {
  return Snapping(input, refined, std::move(nodes), std::move(paths)).run();
}

}  // namespace trimquad
