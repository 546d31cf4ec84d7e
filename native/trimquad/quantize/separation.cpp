#include "trimquad/quantize/separation.h"

#include <algorithm>
#include <limits>
#include <set>
#include <tuple>

namespace trimquad {
namespace {

/// An integer point of a quantized T-mesh: a node, or inside an arc at `at` quads from its start.
struct Point {
  std::optional<NodeId> node;
  ArcId arc{0};
  int at = 0;

  friend auto operator<=>(const Point&, const Point&) = default;
};

/// A unit piece of an arc, from `at` to `at` + 1 quads from its start.
struct Piece {
  ArcId arc;
  int at;
  friend auto operator<=>(const Piece&, const Piece&) = default;
};

/// A line across a zero patch: at `at` quads from the start of side 0 or 1.
struct Crossing {
  PatchId patch;
  int side;
  int at;
  friend auto operator<=>(const Crossing&, const Crossing&) = default;
};

bool isCurve(const TMesh::Arc& arc) {
  return arc.border || arc.critical;
}

class CollapseSearch {
 public:
  CollapseSearch(const Dual& dual, const ArcLengths& q, const std::vector<bool>& isCritical,
                 const std::vector<bool>& onCurve)
      : dual_(dual), tmesh_(*dual.tmesh), q_(q), isCritical_(isCritical), onCurve_(onCurve) {}

  /// The fault of the point's class, unless it was looked at before.
  std::optional<Collapse> faultAt(const Point& start) {
    if (!seen_.insert(start).second) return {};
    std::vector<Point> points{start};
    std::set<ArcId> zeroArcs;
    std::set<Crossing> crossings;
    std::set<PatchId> zeroPatches;
    const auto reach = [&](const Point& p) {
      if (seen_.insert(p).second) points.push_back(p);
    };
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Point p = points[k];
      const auto crossFrom = [&](HalfArc h, int along) {
        const auto& place = dual_.place[h.index()];
        if (!place) return;
        const auto& sides = tmesh_[place->patch].sides;
        const int across = lengthOf(sides[(place->side + 1) % 4], q_),
                  total = lengthOf(sides[place->side], q_);
        if (across > 0) return;
        if (total == 0) {
          zeroPatches.insert(place->patch);
          return;
        }
        for (int i = 0; i < place->index; ++i) along += q_[sides[place->side][i].arc.index];
        if (along == 0 || along == total) return;
        crossings.insert({place->patch, place->side % 2, place->side < 2 ? along : total - along});
        reach(pointOfSide(sides[(place->side + 2) % 4], total - along));
      };
      if (!p.node) {
        crossFrom({p.arc, true}, p.at);
        crossFrom({p.arc, false}, q_[p.arc.index] - p.at);
        continue;
      }
      for (const HalfArc h : dual_.leaving[p.node->index]) {
        crossFrom(h, 0);
        if (q_[h.arc.index] > 0) continue;
        zeroArcs.insert(h.arc);
        reach({tmesh_.end(h)});
      }
    }
    const int characteristic =
        int(points.size()) - int(zeroArcs.size()) - int(crossings.size()) + int(zeroPatches.size());
    const bool forGood = holdsTooMuch(points);
    if (!forGood && characteristic == 1 && curvesAreSound(points, zeroArcs)) return {};
    Collapse collapse;
    collapse.zeroArcs.assign(zeroArcs.begin(), zeroArcs.end());
    std::set<PatchId> patches;
    for (const Crossing& c : crossings) patches.insert(c.patch);
    addArcs(patches, collapse, true);
    if (forGood) return collapse;
    if (characteristic == 1) {
      collapse.mightVanish = leastFrontier(points);
      return collapse;
    }
    // A zero loop is sound if what lies inside it vanishes too.
    for (const Point& p : points) addPatchesAround(p, patches);
    addArcs(patches, collapse, false);
    return collapse;
  }

  /// The fault of the chain of unit pieces that coincide with `start`, unless it was looked at before.
  std::optional<Collapse> faultAlong(const Piece& start) {
    if (!seenPieces_.insert(start).second) return {};
    int curves = isCurve(tmesh_[start.arc]);
    bool isRing = false;
    std::set<PatchId> patches;
    for (const bool forward : {true, false}) {
      HalfArc h{start.arc, forward};
      int at = forward ? start.at : q_[start.arc.index] - 1 - start.at;
      // Cross the patch to the left of h, and the one behind it, and so on.
      while (const auto& place = dual_.place[h.index()]) {
        const auto& sides = tmesh_[place->patch].sides;
        if (lengthOf(sides[(place->side + 1) % 4], q_) > 0) break;
        patches.insert(place->patch);
        for (int i = 0; i < place->index; ++i) at += q_[sides[place->side][i].arc.index];
        int rest = lengthOf(sides[place->side], q_) - 1 - at;
        const TMesh::Side& far = sides[(place->side + 2) % 4];
        std::size_t i = 0;
        while (rest >= q_[far[i].arc.index]) rest -= q_[far[i++].arc.index];
        const Piece piece{far[i].arc, far[i].forward ? rest : q_[far[i].arc.index] - 1 - rest};
        if (piece == start) isRing = true;
        if (isRing || !seenPieces_.insert(piece).second) break;
        curves += isCurve(tmesh_[piece.arc]);
        h = far[i].opposite();
        at = q_[h.arc.index] - 1 - rest;
      }
    }
    if (!isRing && curves <= 1) return {};
    Collapse collapse;
    addArcs(patches, collapse, true);
    return collapse;
  }

 private:
  /// The point at `along` quads of a side: a node if there is one.
  Point pointOfSide(const TMesh::Side& side, int along) const {
    for (const HalfArc h : side) {
      const int length = q_[h.arc.index];
      if (along == 0) return {tmesh_.start(h)};
      if (along < length) return {{}, h.arc, h.forward ? along : length - along};
      along -= length;
    }
    return {tmesh_.end(side.back())};
  }

  /// Two critical nodes, or one inside the surface and away from curves and a part of a curve.
  bool holdsTooMuch(const std::vector<Point>& points) const {
    int critical = 0, lonely = 0, curves = 0;
    for (const Point& p : points) {
      if (!p.node) {
        curves += isCurve(tmesh_[p.arc]);
        continue;
      }
      critical += isCritical_[p.node->index];
      lonely += isCritical_[p.node->index] && !onCurve_[p.node->index];
      curves += onCurve_[p.node->index];
    }
    return critical > 1 || (lonely > 0 && curves > 0);
  }

  /// The parts of boundaries and aligned curves in a class, each a component by the zero arcs of curves.
  std::vector<std::vector<NodeId>> curveParts(const std::vector<Point>& points) const {
    std::vector<std::vector<NodeId>> parts;
    std::set<NodeId> reached;
    for (const Point& p : points) {
      if (!p.node) {
        if (isCurve(tmesh_[p.arc])) parts.emplace_back();
        continue;
      }
      if (!onCurve_[p.node->index] || !reached.insert(*p.node).second) continue;
      std::vector<NodeId> part{*p.node};
      for (std::size_t k = 0; k < part.size(); ++k)
        for (const HalfArc h : dual_.leaving[part[k].index])
          if (isCurve(tmesh_[h.arc]) && q_[h.arc.index] == 0 && reached.insert(tmesh_.end(h)).second)
            part.push_back(tmesh_.end(h));
      parts.push_back(std::move(part));
    }
    return parts;
  }

  /// What a class holds of curves is one tree.
  bool curvesAreSound(const std::vector<Point>& points, const std::set<ArcId>& zeroArcs) const {
    const auto parts = curveParts(points);
    if (parts.size() != 1 || parts.front().empty()) return parts.size() <= 1;
    const auto arcs =
        std::count_if(zeroArcs.begin(), zeroArcs.end(), [&](ArcId a) { return isCurve(tmesh_[a]); });
    return std::size_t(arcs) + 1 == parts.front().size();
  }

  /// The arcs with a length that lead on from one part of the curves in a class: the part with the fewest.
  std::vector<ArcId> leastFrontier(const std::vector<Point>& points) const {
    std::optional<std::set<ArcId>> least;
    for (const auto& part : curveParts(points)) {
      std::set<ArcId> frontier;
      for (const NodeId n : part)
        for (const HalfArc h : dual_.leaving[n.index])
          if (isCurve(tmesh_[h.arc]) && q_[h.arc.index] > 0) frontier.insert(h.arc);
      if (!part.empty() && (!least || frontier.size() < least->size())) least = frontier;
    }
    if (!least) return {};
    return {least->begin(), least->end()};
  }

  void addPatchesAround(const Point& p, std::set<PatchId>& patches) const {
    const auto add = [&](HalfArc h) {
      if (const auto& place = dual_.place[h.index()]) patches.insert(place->patch);
    };
    if (!p.node) {
      add({p.arc, true});
      add({p.arc, false});
      return;
    }
    for (const HalfArc h : dual_.leaving[p.node->index]) add(h);
  }

  void addArcs(const std::set<PatchId>& patches, Collapse& collapse, bool zeroApart) const {
    std::set<ArcId> zero(collapse.zeroArcs.begin(), collapse.zeroArcs.end()), others;
    for (const PatchId p : patches)
      for (const auto& side : tmesh_[p].sides)
        for (const HalfArc h : side)
          if (!zero.contains(h.arc)) (zeroApart && q_[h.arc.index] == 0 ? zero : others).insert(h.arc);
    collapse.zeroArcs.assign(zero.begin(), zero.end());
    collapse.others.assign(others.begin(), others.end());
  }

  const Dual& dual_;
  const TMesh& tmesh_;
  const ArcLengths& q_;
  const std::vector<bool>&isCritical_, &onCurve_;
  std::set<Point> seen_;
  std::set<Piece> seenPieces_;
};

}  // namespace

SeparationTest::SeparationTest(const Dual& dual, Separation separation)
    : dual_(dual),
      tmesh_(*dual.tmesh),
      isCritical_(tmesh_.nodes.size()),
      onCurve_(tmesh_.nodes.size(), false) {
  for (std::size_t n = 0; n < tmesh_.nodes.size(); ++n) isCritical_[n] = tmesh_.nodes[n].critical;
  for (const auto& arc : tmesh_.arcs)
    for (const NodeId n : {arc.from, arc.to}) {
      if (isCurve(arc)) onCurve_[n.index] = true;
      if (separation == Separation::Strong && arc.isVirtual) isCritical_[n.index] = true;
    }
}

bool SeparationTest::mustNotVanish(ArcId arc) const {
  const NodeId a = tmesh_[arc].from, b = tmesh_[arc].to;
  if (a == b) return isCritical_[a.index];
  const auto lonely = [&](NodeId n) { return isCritical_[n.index] && !onCurve_[n.index]; };
  return (isCritical_[a.index] && isCritical_[b.index]) || (lonely(a) && onCurve_[b.index]) ||
         (lonely(b) && onCurve_[a.index]);
}

std::optional<Collapse> SeparationTest::fault(const ArcLengths& q) const {
  return fault(q, allArcs());
}

std::optional<Collapse> SeparationTest::fault(const ArcLengths& q, const std::vector<ArcId>& touched) const {
  auto first = search(q, touched, 1);
  if (first.empty()) return {};
  return std::move(first.front());
}

std::vector<Collapse> SeparationTest::faults(const ArcLengths& q) const {
  return search(q, allArcs(), std::numeric_limits<std::size_t>::max());
}

std::vector<ArcId> SeparationTest::allArcs() const {
  std::vector<ArcId> all;
  for (std::size_t a = 0; a < tmesh_.arcs.size(); ++a) all.push_back({int(a)});
  return all;
}

std::vector<Collapse> SeparationTest::search(const ArcLengths& q, const std::vector<ArcId>& touched,
                                             std::size_t most) const {
  CollapseSearch search(dual_, q, isCritical_, onCurve_);
  std::vector<Collapse> found;
  const auto full = [&](std::optional<Collapse> collapse) {
    if (collapse) found.push_back(std::move(*collapse));
    return found.size() >= most;
  };
  std::set<PatchId> zeroPatches;
  for (const ArcId a : touched) {
    for (const NodeId n : {tmesh_[a].from, tmesh_[a].to})
      if (full(search.faultAt({n}))) return found;
    for (const auto& use : dual_.uses[a.index]) {
      const auto& sides = tmesh_[use.equation.patch()].sides;
      if (lengthOf(sides[0], q) == 0 || lengthOf(sides[1], q) == 0) zeroPatches.insert(use.equation.patch());
    }
  }
  for (const PatchId p : zeroPatches)
    for (const auto& side : tmesh_[p].sides)
      for (const HalfArc h : side) {
        if (full(search.faultAt({tmesh_.start(h)}))) return found;
        for (int k = 0; k < q[h.arc.index]; ++k) {
          if (k > 0 && full(search.faultAt({{}, h.arc, k}))) return found;
          if (full(search.faultAlong({h.arc, k}))) return found;
        }
      }
  return found;
}

}  // namespace trimquad
