#include "trimquad/embed/zero_collapse.h"

#include <algorithm>

#include "trimquad/base/error.h"
#include "trimquad/embed/path_search.h"
#include "trimquad/embed/zero_index.h"
#include "trimquad/mesh/collapse_edge.h"

namespace trimquad {
namespace {

class ZeroCollapse {
 public:
  ZeroCollapse(const SurfaceMesh& input, EmbeddedTMesh& embedded)
      : input_(input),
        t_(embedded),
        mesh_(embedded.surface.mesh),
        patchOf_(2 * embedded.arcs.size()),
        leaving_(embedded.nodes.size()),
        search_(input, embedded.surface, occupied_),
        zeros_(embedded) {
    occupied_.grow(mesh_);
    for (const auto& node : t_.nodes) occupied_.vertex[node.vertex.idx()] = true;
    for (std::size_t a = 0; a < t_.arcs.size(); ++a) {
      setOccupied(ArcId{int(a)}, true);
      addToNodes(ArcId{int(a)});
    }
    for (std::size_t p = 0; p < t_.patches.size(); ++p)
      for (const auto& side : t_.patches[p].sides)
        for (const HalfArc h : side) patchOf_[h.index()] = PatchId{int(p)};
  }

  void run(const Progress& progress, const std::function<void(const EmbeddedTMesh&)>& afterOperation) {
    ZeroIndex::Potential before = zeros_.potential();
    while (step()) {
      progress.check();
      zeros_.update();
      TRIMQUAD_ASSERT(zeros_.potential() < before);
      before = zeros_.potential();
      if (afterOperation) afterOperation(t_);
    }
    TRIMQUAD_ASSERT(zeros_.patches().empty() && zeros_.arcs(true).empty() && zeros_.arcs(false).empty());
  }

 private:
  /// One operator, the simplest that applies. Each works on what the ones before it cannot simplify any more.
  bool step() { return closePatch() || collapseArc(true) || collapseArc(false) || splitPatch(); }

  // --- the T-mesh's loops

  std::optional<PatchId> patchOf(HalfArc h) const { return patchOf_[h.index()]; }

  std::pair<int, std::size_t> placeOf(HalfArc h) const {
    const auto& sides = t_[*patchOf(h)].sides;
    for (int k = 0; k < 4; ++k)
      for (std::size_t i = 0; i < sides[k].size(); ++i)
        if (sides[k][i] == h) return {k, i};
    TRIMQUAD_ASSERT(!"a half-arc is in the loop of its patch");
    return {};
  }

  HalfArc besideInLoop(HalfArc h, int step) const {
    const auto loop = t_.loop(*patchOf(h));
    const auto at = std::size_t(std::find(loop.begin(), loop.end(), h) - loop.begin());
    return loop[(at + loop.size() + std::size_t(step + int(loop.size()))) % loop.size()];
  }
  HalfArc nextInLoop(HalfArc h) const { return besideInLoop(h, 1); }
  HalfArc previousInLoop(HalfArc h) const { return besideInLoop(h, -1); }

  void removeFromLoop(HalfArc h) {
    const auto [side, index] = placeOf(h);
    auto& arcs = t_.patches[patchOf(h)->index].sides[side];
    arcs.erase(arcs.begin() + long(index));
    zeros_.touch(*patchOf(h));
    patchOf_[h.index()].reset();
  }

  /// Zero arcs only: their place between two sides does not matter.
  void insertInLoop(HalfArc h, HalfArc beside, bool before) {
    const auto [side, index] = placeOf(beside);
    auto& arcs = t_.patches[patchOf(beside)->index].sides[side];
    arcs.insert(arcs.begin() + long(index) + !before, h);
    patchOf_[h.index()] = patchOf(beside);
    zeros_.touch(*patchOf(h));
  }

  void replaceInLoop(HalfArc h, HalfArc by) {
    const auto [side, index] = placeOf(h);
    t_.patches[patchOf(h)->index].sides[side][index] = by;
    patchOf_[by.index()] = patchOf(h);
    patchOf_[h.index()].reset();
    zeros_.touch(*patchOf(by));
  }

  // --- the embedding

  void setOccupied(ArcId id, bool taken) {
    const EdgePath& path = t_[id].path;
    for (std::size_t k = 0; k + 1 < path.size(); ++k) {
      if (k > 0) occupied_.vertex[path[k].idx()] = taken;
      occupied_.edge[edgeBetween(path[k], path[k + 1]).idx()] = taken;
    }
  }

  EdgeHandle edgeBetween(VertexHandle a, VertexHandle b) const {
    const HalfedgeHandle h = halfedgeBetween(mesh_, a, b);
    TRIMQUAD_ASSERT(h.is_valid());
    return mesh_.edge_handle(h);
  }

  HalfedgeHandle firstHalfedge(HalfArc h) const {
    const EdgePath& path = t_[h.arc].path;
    return h.forward ? halfedgeBetween(mesh_, path[0], path[1])
                     : halfedgeBetween(mesh_, path[path.size() - 1], path[path.size() - 2]);
  }
  HalfedgeHandle lastHalfedge(HalfArc h) const {
    return mesh_.opposite_halfedge_handle(firstHalfedge(h.opposite()));
  }

  /// Where a half-arc of a patch's loop starts.
  PatchCorner cornerAtStart(HalfArc h) const { return {lastHalfedge(previousInLoop(h)), firstHalfedge(h)}; }
  PatchCorner cornerAtEnd(HalfArc h) const { return cornerAtStart(nextInLoop(h)); }

  PathSearch::Way connect(PatchCorner from, const std::vector<Landing>& landings) {
    return search_.connect(from, landings, t_.counters.splits);
  }

  /// Along the half-arc against its direction, its patch's corners in its inner vertices and its start, where
  /// the way ends.
  std::vector<Landing> landingsBackwards(HalfArc h) const {
    std::vector<Landing> landings;
    const auto along = t_.halfedges(h);
    for (std::size_t k = along.size() - 1; k > 0; --k) landings.push_back({{along[k - 1], along[k]}});
    landings.push_back({cornerAtStart(h)});
    setOnward(landings);
    return landings;
  }

  /// In its direction, to its end.
  std::vector<Landing> landingsForwards(HalfArc h) const {
    std::vector<Landing> landings;
    const auto along = t_.halfedges(h);
    for (std::size_t k = 1; k < along.size(); ++k) landings.push_back({{along[k - 1], along[k]}});
    landings.push_back({cornerAtEnd(h)});
    setOnward(landings);
    return landings;
  }

  void setOnward(std::vector<Landing>& landings) const {
    const auto place = [&](const Landing& l) { return mesh_.point(mesh_.from_vertex_handle(l.corner.out)); };
    for (std::size_t k = landings.size() - 1; k > 0; --k)
      landings[k - 1].onward = landings[k].onward + (place(landings[k]) - place(landings[k - 1])).norm();
  }

  void setPath(HalfArc h, EdgePath path) {
    if (!h.forward) std::reverse(path.begin(), path.end());
    auto& arc = t_.arcs[h.arc.index];
    arc.path = std::move(path);
    setOccupied(h.arc, true);
  }

  void setStart(HalfArc h, NodeId n) {
    std::erase(leaving_[t_.start(h).index], h);
    leaving_[n.index].push_back(h);
    (h.forward ? t_.arcs[h.arc.index].from : t_.arcs[h.arc.index].to) = n;
  }

  /// The arc is new.
  void addToNodes(ArcId id) {
    leaving_.resize(t_.nodes.size());
    for (const HalfArc h : {HalfArc{id, true}, HalfArc{id, false}}) leaving_[t_.start(h).index].push_back(h);
  }

  void removeArc(ArcId id) {
    setOccupied(id, false);
    t_.arcs[id.index].removed = true;
    for (const HalfArc h : {HalfArc{id, true}, HalfArc{id, false}})
      std::erase(leaving_[t_.start(h).index], h);
    zeros_.touch(id);
  }

  // --- operator 1

  bool isCollapsible(HalfArc h) const {
    const auto& node = t_[t_.start(h)];
    return t_.start(h) != t_.end(h) && !node.critical && (t_[h.arc].onCurve || !node.onCurve);
  }

  /// One zero arc, onto the end where it has to be, or else where more arcs are. Curves first: this makes
  /// loops of the arcs that join them to themselves.
  bool collapseArc(bool onCurve) {
    for (const ArcId a : zeros_.arcs(onCurve)) {
      const HalfArc h{a, true};
      const bool there = isCollapsible(h), back = isCollapsible(h.opposite());
      if (!there && !back) continue;
      const bool forward =
          there && back ? leaving_[t_[a].from.index].size() <= leaving_[t_[a].to.index].size() : there;
      collapse(forward ? h : h.opposite());
      ++t_.counters.zeroArcCollapses;
      return true;
    }
    return false;
  }

  /// Onto its end.
  void collapse(HalfArc a) {
    const NodeId gone = t_.start(a), goal = t_.end(a);
    const bool left = patchOf(a).has_value(), right = patchOf(a.opposite()).has_value();
    for (bool onLeft = left;; onLeft = left && (!right || !onLeft)) {
      if (isAntenna(a)) {
        removeFromLoop(a);
        removeFromLoop(a.opposite());
        removeArc(a.arc);
        occupied_.vertex[t_[gone].vertex.idx()] = false;
        break;
      }
      if (t_[a.arc].onCurve && continuesCurve(a, left, right)) break;
      if (onLeft && !slidesAlongCurve(a, previousInLoop(a)))
        slideBefore(previousInLoop(a), a);
      else if (right && !slidesAlongCurve(a, nextInLoop(a.opposite())))
        slideAfter(a.opposite(), nextInLoop(a.opposite()));
    }
    t_.nodes[gone.index].removed = true;
    for (NodeId& n : t_.nodeOf)
      if (n == gone) n = goal;
  }

  bool isAntenna(HalfArc a) const {
    return patchOf(a) && patchOf(a.opposite()) && previousInLoop(a) == a.opposite();
  }

  bool slidesAlongCurve(HalfArc a, HalfArc b) const { return t_[a.arc].onCurve && t_[b.arc].onCurve; }

  /// The arc `b`, which ends in the patch's corner where `a` starts, is moved to end where `a` does: from now
  /// on the patch beyond it borders on `a`. It leaves its path only where that is the shortest way.
  void slideBefore(HalfArc b, HalfArc a) {
    const auto [onward, landing] = connect(cornerAtEnd(a), landingsBackwards(b));
    EdgePath path = t_.path(b);
    path.resize(path.size() - 1 - landing);
    path.insert(path.end(), onward.rbegin() + 1, onward.rend());
    setOccupied(b.arc, false);
    removeFromLoop(a);
    insertInLoop(a, b.opposite(), true);
    setStart(b.opposite(), t_.end(a));
    setPath(b, std::move(path));
  }

  /// The mirror image: `a` ends where `b` starts; now that starts where `a` does.
  void slideAfter(HalfArc a, HalfArc b) {
    auto [path, landing] = connect(cornerAtStart(a), landingsForwards(b));
    const EdgePath old = t_.path(b);
    path.insert(path.end(), old.begin() + long(landing) + 2, old.end());
    setOccupied(b.arc, false);
    removeFromLoop(a);
    insertInLoop(a, b.opposite(), false);
    setStart(b, t_.start(a));
    setPath(b, std::move(path));
  }

  /// Once nothing but the curve itself is left at the start of `a`, the curve's arc before it takes in its
  /// path.
  bool continuesCurve(HalfArc a, bool left, bool right) {
    const auto& others = leaving_[t_.start(a).index];
    TRIMQUAD_ASSERT(others.size() >= 2);
    if (others.size() > 2) return false;
    const HalfArc b = (others[0] == a ? others[1] : others[0]).opposite();  // ends where a starts
    TRIMQUAD_ASSERT(t_[b.arc].onCurve && b.arc != a.arc);
    EdgePath path = t_.path(b);
    const EdgePath onward = t_.path(a);
    path.insert(path.end(), onward.begin() + 1, onward.end());
    setOccupied(b.arc, false);
    if (left) removeFromLoop(a);
    if (right) removeFromLoop(a.opposite());
    setStart(b.opposite(), t_.end(a));
    removeArc(a.arc);
    setPath(b, std::move(path));
    return true;
  }

  // --- operator 3

  /// A patch whose loop is one arc, or two: of two the one that lies on no curve goes, and what is beyond it
  /// takes the patch in.
  bool closePatch() {
    if (zeros_.closable().empty()) return false;
    const PatchId p = *zeros_.closable().begin();
    const auto loop = t_.loop(p);
    TRIMQUAD_ASSERT(!loop.empty());
    HalfArc gone = loop.front(), stays = loop.back();
    if (t_[gone.arc].onCurve) std::swap(gone, stays);
    TRIMQUAD_ASSERT(!t_[gone.arc].onCurve && (loop.size() == 1 || gone.arc != stays.arc));
    for (const HalfArc h : loop) removeFromLoop(h);
    removeArc(gone.arc);
    if (loop.size() == 1)
      removeFromLoop(gone.opposite());
    else
      replaceInLoop(gone.opposite(), stays);
    t_.patches[p.index].removed = true;
    ++t_.counters.patchCollapses;
    return true;
  }

  // --- operator 2

  /// A zero patch with T-joints, at the first of these.
  bool splitPatch() {
    if (zeros_.patches().empty()) return false;
    split(*zeros_.patches().begin());
    ++t_.counters.patchSplits;
    return true;
  }

  void split(PatchId p) {
    const int k = t_.length(t_[p].sides[0]) > 0 ? 0 : 1;
    for (const int zero : {k + 1, (k + 3) % 4}) TRIMQUAD_ASSERT(t_[p].sides[zero].empty());
    const HalfArc near = t_[p].sides[k].front(), far = t_[p].sides[(k + 2) % 4].back();
    const int at = std::min(t_[near.arc].length, t_[far.arc].length);
    TRIMQUAD_ASSERT(at > 0 && at < t_.length(t_[p].sides[k]));
    // From the patch's first corner on, `near` leads away from it and `far` to it.
    const HalfArc first = t_[near.arc].length > at ? splitArc(near, at).first : near;
    const HalfArc last = t_[far.arc].length > at ? splitArc(far, t_[far.arc].length - at).second : far;
    const PatchCorner from = cornerAtEnd(first), to = cornerAtStart(last);
    EdgePath path = connect(from, {{to}}).path;
    const ArcId zero{int(t_.arcs.size())};
    t_.arcs.push_back({t_.end(first), t_.start(last), 0, false, false, {}});
    patchOf_.resize(2 * t_.arcs.size());
    addToNodes(zero);
    setPath({zero, true}, std::move(path));
    const PatchId rest{int(t_.patches.size())};
    t_.patches.emplace_back();
    auto &front = t_.patches[p.index], &back = t_.patches[rest.index];
    auto &nearSide = front.sides[k], &farSide = front.sides[(k + 2) % 4];
    back.sides[k].assign(nearSide.begin() + 1, nearSide.end());
    back.sides[(k + 2) % 4].assign(farSide.begin(), farSide.end() - 1);
    back.sides[(k + 3) % 4] = {{zero, false}};
    nearSide = {first};
    farSide = {last};
    front.sides[k + 1] = {{zero, true}};
    for (const auto& side : back.sides)
      for (const HalfArc h : side) patchOf_[h.index()] = rest;
    patchOf_[2 * zero.index] = p;
    zeros_.touch(zero);
    zeros_.touch(p);
    zeros_.touch(rest);
  }

  /// The two parts, in the direction of `h`, of which the first has the given length.
  std::pair<HalfArc, HalfArc> splitArc(HalfArc h, int length) {
    EdgePath path = t_.path(h);
    const std::size_t cut = cutVertex(path, double(length) / t_[h.arc].length, h.arc);
    const NodeId node{int(t_.nodes.size())};
    const bool onCurve = t_[h.arc].onCurve, border = t_[h.arc].border;
    t_.nodes.push_back({path[cut], false, onCurve});
    const HalfArc rest{ArcId{int(t_.arcs.size())}, true};
    t_.arcs.push_back({node, t_.end(h), t_[h.arc].length - length, border, onCurve,
                       EdgePath(path.begin() + long(cut), path.end())});
    patchOf_.resize(2 * t_.arcs.size());
    addToNodes(rest.arc);
    t_.arcs[h.arc.index].length = length;
    setStart(h.opposite(), node);
    path.resize(cut + 1);
    setPath(h, std::move(path));
    if (patchOf(h)) insertInLoop(rest, h, false);
    if (patchOf(h.opposite())) insertInLoop(rest.opposite(), h.opposite(), true);
    return {h, rest};
  }

  /// An inner vertex of the path, nearest to the given part of its length. The path's edge is split where
  /// there is none.
  std::size_t cutVertex(EdgePath& path, double part, ArcId arc) {
    if (path.size() == 2) {
      setOccupied(arc, false);
      const VertexHandle middle = splitInMiddle(input_, t_.surface, edgeBetween(path[0], path[1]));
      ++t_.counters.splits;
      occupied_.grow(mesh_);
      path.insert(path.begin() + 1, middle);
      auto& stored = t_.arcs[arc.index].path;
      stored.insert(stored.begin() + 1, middle);
      setOccupied(arc, true);
      return 1;
    }
    std::vector<double> along{0};
    for (std::size_t k = 1; k < path.size(); ++k)
      along.push_back(along.back() + (mesh_.point(path[k]) - mesh_.point(path[k - 1])).norm());
    std::size_t best = 1;
    for (std::size_t k = 2; k + 1 < path.size(); ++k)
      if (std::abs(along[k] - part * along.back()) < std::abs(along[best] - part * along.back())) best = k;
    return best;
  }

  const SurfaceMesh& input_;
  EmbeddedTMesh& t_;
  SurfaceMesh& mesh_;
  std::vector<std::optional<PatchId>> patchOf_;  ///< by half-arc
  std::vector<std::vector<HalfArc>> leaving_;    ///< by node
  Occupied occupied_;
  PathSearch search_;
  ZeroIndex zeros_;
};

}  // namespace

void collapseZeros(const SurfaceMesh& input, EmbeddedTMesh& embedded, const Progress& progress,
                   const std::function<void(const EmbeddedTMesh&)>& afterOperation) {
  ZeroCollapse(input, embedded).run(progress, afterOperation);
}

}  // namespace trimquad
