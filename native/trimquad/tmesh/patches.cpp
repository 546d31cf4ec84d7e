#include "trimquad/tmesh/patches.h"

#include <algorithm>
#include <map>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

struct Box {
  FixedVector low, high;

  void add(FixedVector x) {
    low = {std::min(low.u, x.u), std::min(low.v, x.v)};
    high = {std::max(high.u, x.u), std::max(high.v, x.v)};
  }
  /// Where the side that runs in direction `quarters` ends, walking counter-clockwise.
  FixedVector corner(int quarters) const {
    switch (quarters & 3) {
      case 0:
        return {high.u, low.v};
      case 1:
        return high;
      case 2:
        return {low.u, high.v};
      default:
        return low;
    }
  }
};

/// A halfedge on the way along the boundary, and the chart change from its triangle to the patch's chart.
struct Position {
  HalfedgeHandle h;
  Transition toPatch;
};

struct RedWalk {
  NodeId from, to;
  FixedVector start, end;  ///< in the patch's chart
  int direction = 0;       ///< of the arc that ends in `from`
  int corners = 0;         ///< that are cut off
  std::vector<HalfedgeHandle> edges;
  std::vector<std::pair<FixedVector, VertexHandle>> vertices;  ///< inside, in the patch's chart
  std::vector<std::pair<FixedVector, NodeId>> nodes;           ///< critical ones inside, in the patch's chart
};

/// A piece of a patch's loop: a real half-arc, or a red segment.
struct Piece {
  std::optional<HalfArc> arc;
  int direction = 0;  ///< in the patch's chart
  std::size_t red = 0;
};

struct Loop {
  std::vector<Piece> pieces;
  std::vector<RedWalk> reds;
  Box box;
};

class PatchWalk {
 public:
  PatchWalk(const Parametrization& map, const std::vector<Seeds::Node>& nodes, std::vector<TMesh::Arc> arcs)
      : map_(map), mesh_(map.mesh), around_(spokesAround(map, nodes, arcs)) {
    tmesh_.scale = map.scale;
    tmesh_.arcs = std::move(arcs);
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      const bool critical =
          nodes[n].kind == TMesh::NodeKind::Singular || nodes[n].kind == TMesh::NodeKind::Feature;
      tmesh_.nodes.push_back({nodes[n].kind, critical, around_[n].quarters == 0, nodes[n].place,
                              placeInSpace(map, nodes[n].place)});
      if (nodes[n].kind == TMesh::NodeKind::TJunction && around_[n].spokes.size() == 4)
        tmesh_.nodes[n].kind = TMesh::NodeKind::Regular;
      const auto& element = nodes[n].place.element;
      if (const auto* v = std::get_if<VertexHandle>(&element)) nodeOfVertex_[*v] = NodeId{int(n)};
      if (const auto* e = std::get_if<EdgeHandle>(&element); e && mesh_.is_boundary(*e))
        nodesOfEdge_[*e].push_back(NodeId{int(n)});
    }
    for (auto& [e, along] : nodesOfEdge_) {
      const HalfedgeHandle side = chartSide(mesh_, e);
      std::sort(along.begin(), along.end(), [&](NodeId a, NodeId b) {
        return compareAlong(map_, side, *tmesh_[a].place, *tmesh_[b].place) < 0;
      });
    }
  }

  TMesh run() && {
    const int realArcs = int(tmesh_.arcs.size());
    std::vector<bool> walked(2 * realArcs, false);
    for (int index = 0; index < 2 * realArcs; ++index) {
      const HalfArc h = HalfArc::at(index);
      if (walked[index] || outside(h)) continue;
      const Loop loop = walk(h);
      for (const Piece& piece : loop.pieces)
        if (piece.arc) {
          TRIMQUAD_ASSERT(!walked[piece.arc->index()]);
          walked[piece.arc->index()] = true;
        }
      complete(loop);
    }
    return std::move(tmesh_);
  }

 private:
  /// Along an aligned boundary, seen from where there is no surface.
  bool outside(HalfArc h) const {
    return tmesh_[h.arc].border && !triangleOnLeft(map_, firstLeg(tmesh_[h.arc], h.forward));
  }

  /// The loop with the patch to its left that `first` lies on, in the chart where `first` starts at the
  /// origin.
  Loop walk(HalfArc first) const {
    Loop loop;
    FixedVector x;
    HalfArc h = first;
    int direction = 0, turning = 0;
    do {
      loop.pieces.push_back({h, direction & 3});
      x = x + rotated({tmesh_[h.arc].length, 0}, direction);
      loop.box.add(x);
      const NodeId node = tmesh_.end(h);
      const Spokes& here = around_[node.index];
      const std::size_t k = spokeOf(here, h.opposite());
      if (here.quarters == 0 && k == 0) {
        RedWalk red = walkBoundary(node, here.spokes[k], x, direction);
        turning += red.corners, direction += red.corners;
        x = red.end;
        h = around_[red.to.index].spokes.back().arc;
        for (const auto& [place, vertex] : red.vertices) loop.box.add(place);
        loop.box.add(x);
        loop.pieces.push_back({{}, 0, loop.reds.size()});
        loop.reds.push_back(std::move(red));
      } else {
        const auto& next = here.spokes[k > 0 ? k - 1 : here.spokes.size() - 1];
        const int gap = here.spokes[k].slot - next.slot + (k > 0 ? 0 : here.quarters);
        TRIMQUAD_ASSERT(gap == 1 || gap == 2);
        turning += 2 - gap, direction += 2 - gap;
        h = next.arc;
      }
    } while (h != first);
    TRIMQUAD_ASSERT(turning == 4 && x == FixedVector{});
    return loop;
  }

  static std::size_t spokeOf(const Spokes& here, HalfArc leaving) {
    const auto found = std::find_if(here.spokes.begin(), here.spokes.end(),
                                    [&](const Spokes::Spoke& s) { return s.arc == leaving; });
    TRIMQUAD_ASSERT(found != here.spokes.end());
    return std::size_t(found - here.spokes.begin());
  }

  /// From where an arc in `direction` of the patch's chart ends on the boundary, in the point x there, to
  /// where the next one starts. `arrival` is the arc's spoke.
  RedWalk walkBoundary(NodeId from, const Spokes::Spoke& arrival, FixedVector x, int direction) const {
    RedWalk red;
    red.from = from;
    red.start = x;
    red.direction = direction & 3;
    Position at;
    at.h = arrival.corner;
    at.toPatch.rotation = (direction + 2 - arrival.direction) & 3;
    at.toPatch.translation =
        x - rotated(positionInChart(map_, arrival.corner, *tmesh_[from].place), at.toPatch.rotation);
    if (const auto* e = std::get_if<EdgeHandle>(&tmesh_[from].place->element))
      at.h = chartSide(mesh_, *e);
    else
      at = clockwiseToBoundary(at);
    red.edges.push_back(at.h);
    std::optional<NodeId> next = nodeBehind(at.h, from);
    while (!next || around_[next->index].spokes.empty()) {
      const VertexHandle v = mesh_.to_vertex_handle(at.h);
      const FixedVector place = at.toPatch(map_.to(at.h));
      red.vertices.emplace_back(place, v);
      if (next) red.nodes.emplace_back(place, *next);
      at.h = mesh_.next_halfedge_handle(at.h);
      at = clockwiseToBoundary(at);
      red.edges.push_back(at.h);
      next = nodeBehind(at.h, {});
    }
    red.to = *next;
    const Spokes::Spoke& departure = around_[next->index].spokes.back();
    if (std::holds_alternative<VertexHandle>(tmesh_[*next].place->element)) {
      at.h = mesh_.next_halfedge_handle(at.h);
      while (at.h != departure.corner) {
        // A line along a boundary edge belongs to the corner to its right.
        TRIMQUAD_ASSERT(!mesh_.is_boundary(mesh_.opposite_halfedge_handle(at.h)));
        at = clockwise(at);
      }
    }
    red.end = at.toPatch(positionInChart(map_, at.h, *tmesh_[*next].place));
    red.corners = (departure.direction + at.toPatch.rotation - direction) & 3;
    if (red.corners == 0) red.corners = 4;
    return red;
  }

  /// From a halfedge that leaves a vertex to the one clockwise of it.
  Position clockwise(const Position& at) const {
    const HalfedgeHandle other = mesh_.opposite_halfedge_handle(at.h);
    return {mesh_.next_halfedge_handle(other), at.toPatch.after(map_.transition(other))};
  }

  Position clockwiseToBoundary(Position at) const {
    while (!mesh_.is_boundary(mesh_.opposite_halfedge_handle(at.h))) at = clockwise(at);
    return at;
  }

  /// The first node on the boundary halfedge h after `from` (from its start where that is none), its end
  /// included.
  std::optional<NodeId> nodeBehind(HalfedgeHandle h, std::optional<NodeId> from) const {
    if (const auto along = nodesOfEdge_.find(mesh_.edge_handle(h)); along != nodesOfEdge_.end()) {
      auto node = along->second.begin();
      if (from)
        if (const auto found = std::find(node, along->second.end(), *from); found != along->second.end())
          node = found + 1;
      if (node != along->second.end()) return *node;
    }
    const auto node = nodeOfVertex_.find(mesh_.to_vertex_handle(h));
    if (node == nodeOfVertex_.end()) return {};
    return node->second;
  }

  /// Adds the patch and its virtual arcs.
  void complete(const Loop& loop) {
    const PatchId patch{int(tmesh_.patches.size())};
    std::vector<std::pair<HalfArc, int>> around;
    for (const Piece& piece : loop.pieces) {
      if (piece.arc) {
        around.emplace_back(*piece.arc, piece.direction);
        continue;
      }
      const RedWalk& red = loop.reds[piece.red];
      TMesh::RedSegment segment{patch, virtualArcs(red, loop.box), red.edges};
      for (std::size_t k = 0; k < segment.virtualArcs.size(); ++k)
        around.emplace_back(segment.virtualArcs[k], int(red.direction + k) & 3);
      tmesh_.redSegments.push_back(std::move(segment));
    }
    std::size_t first = 0;
    while (around[first].second == around[(first + around.size() - 1) % around.size()].second) ++first;
    TMesh::Patch result;
    for (std::size_t k = 0; k < around.size(); ++k) {
      const auto& [arc, direction] = around[(first + k) % around.size()];
      result.sides[(direction - around[first].second) & 3].push_back(arc);
    }
    result.type = patchType(tmesh_, result.sides);
    tmesh_.patches.push_back(std::move(result));
  }

  std::vector<HalfArc> virtualArcs(const RedWalk& red, const Box& box) {
    std::vector<HalfArc> chain;
    NodeId from = red.from;
    FixedVector x = red.start;
    std::size_t met = 0;
    for (int k = 0; k <= red.corners; ++k) {
      const FixedVector goal = k < red.corners ? box.corner(red.direction + k) : red.end;
      const FixedVector step = rotated(goal - x, 4 - ((red.direction + k) & 3));
      TRIMQUAD_ASSERT(step.v == 0 && step.u >= 0);
      const NodeId to = k < red.corners ? cornerNode(red, goal, met) : red.to;
      chain.push_back({ArcId{int(tmesh_.arcs.size())}, true});
      tmesh_.arcs.push_back({from, to, step.u, true, true, false, {}});
      from = to, x = goal;
    }
    TRIMQUAD_ASSERT(met == red.nodes.size());
    return chain;
  }

  /// A critical node in which no arc ends is a tip of the boundary, and as such a corner of the rectangle.
  NodeId cornerNode(const RedWalk& red, FixedVector corner, std::size_t& met) {
    for (const auto& [place, node] : red.nodes)
      if (place == corner) {
        ++met;
        return node;
      }
    Eigen::Vector3d position = tmesh_[red.from].position;
    const auto distance = [&](FixedVector a) { return dot(a - corner, a - corner); };
    WideQuanta least = distance(red.start);
    if (distance(red.end) < least) least = distance(red.end), position = tmesh_[red.to].position;
    for (const auto& [place, vertex] : red.vertices)
      if (distance(place) < least) least = distance(place), position = mesh_.point(vertex);
    tmesh_.nodes.push_back({TMesh::NodeKind::Virtual, false, true, {}, position});
    return NodeId{int(tmesh_.nodes.size()) - 1};
  }

  const Parametrization& map_;
  const SurfaceMesh& mesh_;
  const std::vector<Spokes> around_;
  TMesh tmesh_;
  std::map<VertexHandle, NodeId> nodeOfVertex_;
  std::map<EdgeHandle, std::vector<NodeId>>
      nodesOfEdge_;  ///< inside boundary edges, in their side's direction
};

}  // namespace

TMesh completedPatches(const Parametrization& map, const std::vector<Seeds::Node>& nodes,
                       std::vector<TMesh::Arc> arcs) {
  return PatchWalk(map, nodes, std::move(arcs)).run();
}

}  // namespace trimquad
