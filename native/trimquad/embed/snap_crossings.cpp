#include <algorithm>

#include "trimquad/embed/exact_arcs.h"

namespace trimquad {
namespace {

using Origin = RefinedMesh::Origin;

class CrossingSnap {
 public:
  CrossingSnap(const SurfaceMesh& input, ExactArcs& arcs)
      : input_(input),
        arcs_(arcs),
        hasNode_(input.n_faces(), false),
        taken_(input.n_vertices(), false),
        outermost_(arcs.origins.size(), {false, false}),
        standIn_(arcs.origins.size()) {}

  void run() {
    for (const Origin& origin : arcs_.origins)
      if (const auto* f = std::get_if<FaceHandle>(&origin.element)) hasNode_[f->idx()] = true;
    for (const auto& node : arcs_.paths.node)
      if (node && isOfInput(*node)) taken_[node->idx()] = true;
    for (const EdgePath& path : arcs_.paths.arc)
      for (const VertexHandle v : path)
        if (isOfInput(v)) taken_[v.idx()] = true;
    findOutermost();
    for (EdgePath& path : arcs_.paths.arc)
      if (!path.empty()) snap(path);
    std::erase_if(arcs_.segments, [&](ArcSegment& s) { return !followStandIns(s); });
    dropSnapped();
  }

 private:
  bool isOfInput(VertexHandle v) const { return std::size_t(v.idx()) < input_.n_vertices(); }
  std::size_t added(VertexHandle v) const { return std::size_t(v.idx()) - input_.n_vertices(); }

  void findOutermost() {
    for (const EdgeHandle e : arcs_.crossed) {
      const VertexHandle* first = &arcs_.along[std::size_t(arcs_.onEdge[e.idx()])];
      outermost_[added(*first)][0] = true;
      while (first[1].is_valid()) ++first;
      outermost_[added(*first)][1] = true;
    }
  }

  /// Inside an arc, whose vertices in edges are no nodes.
  void snap(EdgePath& path) {
    VertexHandle last;
    std::size_t length = 1;
    for (std::size_t k = 1; k < path.size(); ++k) {
      VertexHandle v = path[k];
      const bool isInside = k + 1 < path.size() && !isOfInput(v);
      last = isInside ? freeEnd(added(v), last) : VertexHandle();
      if (last.is_valid()) {
        standIn_[added(v)] = last;
        taken_[last.idx()] = true;
        v = last;
      }
      if (v != path[length - 1]) path[length++] = v;
    }
    path.resize(length);
  }

  /// The nearest end of a crossing's edge to which it is next and that is free, or taken by `last`, through
  /// which the same arc comes.
  VertexHandle freeEnd(std::size_t crossing, VertexHandle last) const {
    const Origin& origin = arcs_.origins[crossing];
    const auto* e = std::get_if<EdgeHandle>(&origin.element);
    if (!e || input_.is_boundary(*e)) return VertexHandle();
    for (const int side : {0, 1})
      if (hasNode_[input_.face_handle(input_.halfedge_handle(*e, side)).idx()]) return VertexHandle();
    const int nearest = origin.weights[1] > 0.5;
    for (const int end : {nearest, 1 - nearest}) {
      if (!outermost_[crossing][end]) continue;
      const VertexHandle v = input_.to_vertex_handle(input_.halfedge_handle(*e, 1 - end));
      if (v == last || (!taken_[v.idx()] && !input_.is_boundary(v))) return v;
    }
    return VertexHandle();
  }

  /// Moves the ends of a segment; whether it still goes through its triangle.
  bool followStandIns(ArcSegment& s) const {
    for (const int k : {0, 1})
      if (!isOfInput(s.end[k]) && standIn_[added(s.end[k])].is_valid())
        s.end[k] = standIn_[added(s.end[k])], s.moved[k] = true;
    if (!s.moved[0] && !s.moved[1]) return true;
    s.line = {ChartLine::Kind::Cut, -2 - Quanta(&s - arcs_.segments.data())};
    if (isOfInput(s.end[0]) && isOfInput(s.end[1])) return false;
    for (const int k : {0, 1})
      if (isOfInput(s.end[k])) return !closureHolds(input_, arcs_.origins[added(s.end[1 - k])], {s.end[k]});
    return true;
  }

  /// Numbers the new vertices without those that were snapped.
  void dropSnapped() {
    std::vector<VertexHandle> renamed(arcs_.origins.size());
    std::size_t count = 0;
    for (std::size_t k = 0; k < arcs_.origins.size(); ++k) {
      if (standIn_[k].is_valid()) continue;
      arcs_.origins[count] = arcs_.origins[k], arcs_.places[count] = arcs_.places[k];
      renamed[k] = VertexHandle(int(input_.n_vertices() + count++));
    }
    arcs_.origins.resize(count), arcs_.places.resize(count);
    const auto rename = [&](VertexHandle& v) {
      if (!isOfInput(v)) v = renamed[added(v)];
    };
    for (auto& node : arcs_.paths.node)
      if (node) rename(*node);
    for (EdgePath& path : arcs_.paths.arc)
      for (VertexHandle& v : path) rename(v);
    for (ArcSegment& s : arcs_.segments) rename(s.end[0]), rename(s.end[1]);
    std::size_t end = 0;
    for (const EdgeHandle e : arcs_.crossed) {
      int& first = arcs_.onEdge[e.idx()];
      std::size_t k = std::size_t(first);
      first = int(end);
      for (; arcs_.along[k].is_valid(); ++k)
        if (const VertexHandle v = renamed[added(arcs_.along[k])]; v.is_valid()) arcs_.along[end++] = v;
      if (end > std::size_t(first))
        arcs_.along[end++] = VertexHandle();
      else
        first = -1;
    }
    arcs_.along.resize(end);
    std::erase_if(arcs_.crossed, [&](EdgeHandle e) { return arcs_.onEdge[e.idx()] < 0; });
  }

  const SurfaceMesh& input_;
  ExactArcs& arcs_;
  std::vector<bool> hasNode_;  ///< by triangle: inside
  std::vector<bool> taken_;    ///< by vertex of the input: an arc runs through it
  /// By new vertex in an edge: next to the start of its halfedge 0, next to its end.
  std::vector<std::array<bool, 2>> outermost_;
  std::vector<VertexHandle> standIn_;  ///< by new vertex: that of the input it is snapped to, if any
};

}  // namespace

void snapCrossings(const SurfaceMesh& input, ExactArcs& arcs) {
  CrossingSnap(input, arcs).run();
}

}  // namespace trimquad
