#include "trimquad/quads/detour.h"

#include <algorithm>

namespace trimquad {
namespace {

using PointsBeyond = std::vector<std::optional<std::vector<int>>>;

class Detours {
 public:
  Detours(const SimpleLoops& cell, const PointsBeyond& beyond)
      : loops_(cell.loops), spurs_(cell.spurs), beyond_(beyond) {}

  std::optional<Detour> shortest() const {
    std::optional<Detour> best;
    for (size_t hole = 1; hole < loops_.size(); ++hole)
      for (size_t side = 0; side < loops_[0].size(); ++side) {
        if (!beyond_[side]) continue;
        const auto detour = through(side, hole);
        if (detour && (!best || detour->length < best->length)) best = detour;
      }
    return best;
  }

 private:
  const PlanarCorner& corner(size_t k) const { return loops_[0][k % loops_[0].size()]; }

  /// The corners of a hole that a corner of the outer loop sees, the two nearest ones. Not inner ones, which
  /// would get an edge more.
  std::vector<size_t> nearest(size_t from, const PlanarLoop& hole) const {
    from %= loops_[0].size();
    const PlanarCorner& start = corner(from);
    std::vector<std::pair<WideQuanta, size_t>> sorted;
    for (size_t k = 0; k < hole.size(); ++k)
      if (!hole[k].inner) sorted.push_back({squaredDistance(start, hole[k]), k});
    std::sort(sorted.begin(), sorted.end());
    std::vector<size_t> seen;
    for (const auto& [distance, k] : sorted) {
      if (!leadsInside(loops_[0], from, hole[k].at) || !leadsInside(hole, k, start.at) ||
          crossings(loops_, start, hole[k]) > 0 || crossesSpur(start, hole[k]) || isSpur(start, hole[k]))
        continue;
      seen.push_back(k);
      if (seen.size() == 2) break;
    }
    return seen;
  }

  bool crossesSpur(const PlanarCorner& p, const PlanarCorner& q) const {
    return std::any_of(spurs_.begin(), spurs_.end(),
                       [&](const Spur& spur) { return meet(p, q, spur[0], spur[1]); });
  }

  bool isSpur(const PlanarCorner& p, const PlanarCorner& q) const {
    return std::any_of(spurs_.begin(), spurs_.end(), [&](const Spur& spur) {
      return (spur[0].point == p.point && spur[1].point == q.point) ||
             (spur[0].point == q.point && spur[1].point == p.point);
    });
  }

  std::optional<Detour> through(size_t side, size_t h) const {
    const PlanarLoop& hole = loops_[h];
    const PlanarCorner &start = corner(side), &end = corner(side + 1);
    const size_t atStart = positionIn(hole, start.point), atEnd = positionIn(hole, end.point);
    const bool beside = atStart < hole.size() || atEnd < hole.size();
    const auto touches = touchesOuter(hole);
    const bool inner = std::any_of(touches.begin(), touches.end(), [](const auto& c) { return c.inner; });
    // It is met there already. But an inner point would lose an edge.
    if (!touches.empty() && (inner ? beside || touches.size() > 1 : !beside)) return {};
    const auto entries = atStart < hole.size() ? std::vector{atStart} : nearest(side, hole);
    const auto exits = atEnd < hole.size() ? std::vector{atEnd} : nearest(side + 1, hole);
    std::optional<Detour> best;
    for (const size_t entry : entries)
      for (const size_t exit : exits) {
        if (entry == exit || meet(start, hole[entry], end, hole[exit])) continue;
        const Detour detour{side, h, entry, exit,
                            squaredDistance(start, hole[entry]) + squaredDistance(end, hole[exit])};
        if ((!best || detour.length < best->length) && isFree(detour)) best = detour;
      }
    return best;
  }

  std::vector<PlanarCorner> touchesOuter(const PlanarLoop& hole) const {
    std::vector<PlanarCorner> touches;
    for (const PlanarCorner& c : hole)
      if (positionIn(loops_[0], c.point) < loops_[0].size()) touches.push_back(c);
    return touches;
  }

  /// Whether what comes to the other cell is a polygon without other holes that meets the rest of it in the
  /// side only, and no spur leads there.
  bool isFree(const Detour& detour) const {
    PlanarLoop between = stretch(loops_[detour.hole], detour.exit, detour.entry);
    const std::vector<int>& beyond = *beyond_[detour.side];
    for (const PlanarCorner& c : between) {
      if (c.point == corner(detour.side).point || c.point == corner(detour.side + 1).point) continue;
      if (positionIn(loops_[0], c.point) < loops_[0].size()) return false;
      if (std::find(beyond.begin(), beyond.end(), c.point) != beyond.end()) return false;
    }
    for (size_t k = 1; k + 1 < between.size(); ++k)
      for (const Spur& spur : spurs_)
        if (between[k].point == spur[0].point || between[k].point == spur[1].point) return false;
    between.push_back(corner(detour.side));
    between.push_back(corner(detour.side + 1));
    if (doubleArea(between) <= 0) return false;
    for (size_t l = 1; l < loops_.size(); ++l)
      if (l != detour.hole && isInside(between, loops_[l][0].at)) return false;
    return true;
  }

  const std::vector<PlanarLoop>& loops_;
  const std::vector<Spur>& spurs_;
  const PointsBeyond& beyond_;
};

}  // namespace

std::optional<Detour> shortestDetour(const SimpleLoops& cell, const PointsBeyond& beyond) {
  return Detours(cell, beyond).shortest();
}

}  // namespace trimquad
