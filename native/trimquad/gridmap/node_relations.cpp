#include "trimquad/gridmap/node_relations.h"

#include <string>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

/// A walk over triangles, and what it does to coordinates.
class Walk {
 public:
  Walk(const SurfaceMesh& mesh, const SeamGraph& seams, FaceHandle start)
      : mesh_(mesh), seams_(seams), here_(start) {}

  /// To a triangle that has the point as well, the short way around it.
  void to(FaceHandle goal, const SurfacePoint& through) {
    if (goal == here_) return;
    if (const auto* v = std::get_if<VertexHandle>(&through.element)) return around(goal, *v);
    const auto* e = std::get_if<EdgeHandle>(&through.element);
    TRIMQUAD_ASSERT(e != nullptr);
    for (int side = 0; side < 2; ++side)
      if (const auto h = mesh_.halfedge_handle(*e, side); mesh_.face_handle(h) == here_) {
        cross(h);
        break;
      }
    TRIMQUAD_ASSERT(here_ == goal);
  }

  /// To another triangle at the vertex, without leaving the surface.
  void around(FaceHandle goal, VertexHandle v) {
    for (const bool counterClockwise : {true, false}) {
      Walk walk = *this;
      HalfedgeHandle out;
      for (const auto h : mesh_.voh_range(v))
        if (!mesh_.is_boundary(h) && mesh_.face_handle(h) == here_) out = h;
      TRIMQUAD_ASSERT(out.is_valid());
      for (const auto start = out; walk.here_ != goal;) {
        const auto side = counterClockwise ? mesh_.prev_halfedge_handle(out) : out;
        const auto other = mesh_.opposite_halfedge_handle(side);
        if (mesh_.is_boundary(other)) break;
        walk.cross(side);
        out = counterClockwise ? other : mesh_.next_halfedge_handle(other);
        if (out == start) break;
      }
      if (walk.here_ != goal) continue;
      here_ = walk.here_;
      path_ = walk.path_;
      return;
    }
    TRIMQUAD_ASSERT(false);
  }

  void cross(HalfedgeHandle side) {
    if (const auto& crossing = seams_.crossing[side.idx()]) path_.cross(seams_, *crossing);
    here_ = mesh_.opposite_face_handle(side);
  }

  void move(int direction, int quads) { path_.move(rotated({quads, 0}, direction)); }
  const PathTransition& path() const { return path_; }

 private:
  const SurfaceMesh& mesh_;
  const SeamGraph& seams_;
  FaceHandle here_;
  PathTransition path_;
};

class NodeRelations {
 public:
  NodeRelations(const SurfaceMesh& mesh, const SeamGraph& seams, const TMesh& tmesh,
                const Quantization& quantization)
      : mesh_(mesh), seams_(seams), tmesh_(tmesh), quantization_(quantization) {}

  GridPoints run() {
    point_.assign(tmesh_.nodes.size(), -1);
    for (size_t n = 0; n < tmesh_.nodes.size(); ++n) {
      const auto& node = tmesh_.nodes[n];
      if (!node.place) continue;
      point_[n] = grid_.count++;
      const auto* v = std::get_if<VertexHandle>(&node.place->element);
      TRIMQUAD_ASSERT(!node.critical || v != nullptr);
      if (node.critical) grid_.places.push_back({point_[n], cornerAt(*v)});
    }
    for (size_t a = 0; a < tmesh_.arcs.size(); ++a)
      if (!tmesh_.arcs[a].isVirtual) relateArc(ArcId{int(a)});
    for (const auto& segment : tmesh_.redSegments) relateAcross(segment);
    return std::move(grid_);
  }

 private:
  HalfedgeHandle cornerAt(VertexHandle v) const {
    for (const auto h : mesh_.voh_range(v))
      if (!mesh_.is_boundary(h)) return h;
    throw stageError("optimize", "a vertex without a triangle", "vertex " + std::to_string(v.idx()));
  }

  /// The triangle in whose chart the node's coordinates are.
  FaceHandle chartOf(NodeId n) const {
    const auto& place = *tmesh_[n].place;
    if (const auto* v = std::get_if<VertexHandle>(&place.element)) return mesh_.face_handle(cornerAt(*v));
    if (const auto* e = std::get_if<EdgeHandle>(&place.element))
      return mesh_.face_handle(chartSide(mesh_, *e));
    return std::get<FaceHandle>(place.element);
  }

  int length(ArcId a) const { return int(quantization_.length[a.index]); }

  void relate(NodeId from, NodeId to, const Walk& walk) {
    grid_.relations.push_back({point_[from.index], point_[to.index], walk.path()});
  }

  void relateArc(ArcId a) {
    const auto& arc = tmesh_[a];
    Walk walk(mesh_, seams_, chartOf(arc.from));
    bool moved = false;
    for (const auto& leg : arc.legs) {
      walk.to(mesh_.face_handle(leg.side), leg.from);
      if (!moved) walk.move(leg.direction, length(a));
      moved = true;
    }
    walk.to(chartOf(arc.to), arc.legs.back().to);
    relate(arc.from, arc.to, walk);
  }

  /// The half-arc before the first virtual one in the loop of the segment's patch.
  HalfArc before(const TMesh::RedSegment& segment) const {
    std::vector<HalfArc> loop;
    for (const auto& side : tmesh_[segment.patch].sides) loop.insert(loop.end(), side.begin(), side.end());
    for (size_t k = 0; k < loop.size(); ++k)
      if (loop[k] == segment.virtualArcs.front()) return loop[(k + loop.size() - 1) % loop.size()];
    throw stageError("optimize", "a virtual arc that its patch does not have");
  }

  void relateAcross(const TMesh::RedSegment& segment) {
    const HalfArc in = before(segment);
    TRIMQUAD_ASSERT(!tmesh_[in.arc].isVirtual);
    const auto& legs = tmesh_[in.arc].legs;
    const TMesh::Leg& last = in.forward ? legs.back() : legs.front();
    const int direction = in.forward ? last.direction : last.direction + 2;
    const NodeId from = tmesh_.start(segment.virtualArcs.front());
    TRIMQUAD_ASSERT(from == tmesh_.end(in));
    Walk start(mesh_, seams_, chartOf(from));
    start.to(mesh_.face_handle(last.side), *tmesh_[from].place);
    for (size_t k = 0; k < segment.virtualArcs.size(); ++k) {
      // The k-th virtual arc has turned left k times.
      start.move(direction + int(k), length(segment.virtualArcs[k].arc));
      const NodeId to = tmesh_.end(segment.virtualArcs[k]);
      const bool isLast = k + 1 == segment.virtualArcs.size();
      if (!tmesh_[to].place) continue;
      Walk walk = start;
      walk.to(mesh_.face_handle(segment.edges.front()), *tmesh_[from].place);
      const auto* tip = isLast ? nullptr : std::get_if<VertexHandle>(&tmesh_[to].place->element);
      for (size_t i = 0;; ++i) {
        const auto v = mesh_.to_vertex_handle(segment.edges[i]);
        if (tip ? v == *tip : i + 1 == segment.edges.size()) break;
        walk.around(mesh_.face_handle(segment.edges[i + 1]), v);
      }
      walk.to(chartOf(to), *tmesh_[to].place);
      relate(from, to, walk);
    }
  }

  const SurfaceMesh& mesh_;
  const SeamGraph& seams_;
  const TMesh& tmesh_;
  const Quantization& quantization_;
  std::vector<int> point_;  ///< by node; -1 for virtual ones
  GridPoints grid_;
};

}  // namespace

GridPoints gridPoints(const SurfaceMesh& mesh, const SeamGraph& seams, const TMesh& tmesh,
                      const Quantization& quantization) {
  return NodeRelations(mesh, seams, tmesh, quantization).run();
}

}  // namespace trimquad
