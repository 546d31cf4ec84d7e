#include "trimquad/quads/planar_loop.h"

#include <algorithm>

namespace trimquad {

WideQuanta doubleArea(const PlanarLoop& loop) {
  WideQuanta area = 0;
  for (std::size_t k = 1; k + 1 < loop.size(); ++k)
    area += cross(loop[k].at - loop[0].at, loop[k + 1].at - loop[0].at);
  return area;
}

bool meet(const PlanarCorner& p, const PlanarCorner& q, const PlanarCorner& r, const PlanarCorner& s) {
  const auto inside = [](const PlanarCorner& a, const PlanarCorner& b, const PlanarCorner& x) {
    return x.point != a.point && x.point != b.point && orientation(a.at, b.at, x.at) == 0 &&
           dot(a.at - x.at, b.at - x.at) <= 0;
  };
  if (inside(p, q, r) || inside(p, q, s) || inside(r, s, p) || inside(r, s, q)) return true;
  return orientation(p.at, q.at, r.at) * orientation(p.at, q.at, s.at) < 0 &&
         orientation(r.at, s.at, p.at) * orientation(r.at, s.at, q.at) < 0;
}

int crossings(const std::vector<PlanarLoop>& loops, const PlanarCorner& p, const PlanarCorner& q) {
  int count = 0;
  for (const auto& loop : loops)
    for (std::size_t k = 0; k < loop.size(); ++k) count += meet(p, q, loop[k], loop[(k + 1) % loop.size()]);
  return count;
}

bool leadsInside(const PlanarLoop& loop, std::size_t i, FixedVector x) {
  const FixedVector here = loop[i].at;
  const FixedVector out = loop[(i + 1) % loop.size()].at - here;
  const FixedVector in = loop[(i + loop.size() - 1) % loop.size()].at - here;
  return strictlyInsideSector(out, in, x - here);
}

std::size_t positionIn(const PlanarLoop& loop, int point) {
  const auto found = std::find_if(loop.begin(), loop.end(), [&](const auto& c) { return c.point == point; });
  return std::size_t(found - loop.begin());
}

std::vector<PlanarLoop> dividedWherePinched(const std::vector<PlanarLoop>& loops) {
  std::vector<PlanarLoop> divided;
  for (const auto& loop : loops) {
    PlanarLoop open;
    std::vector<PlanarLoop> closed;
    for (const auto& corner : loop) {
      const std::size_t before = positionIn(open, corner.point);
      if (before < open.size() && !corner.inner) {
        closed.emplace_back(open.begin() + long(before), open.end());
        open.resize(before);
      }
      open.push_back(corner);
    }
    closed.push_back(open);
    // The outer part first, as the outer loop was.
    const auto outer =
        std::find_if(closed.begin(), closed.end(), [](const auto& l) { return doubleArea(l) > 0; });
    if (outer != closed.end()) std::rotate(closed.begin(), outer, outer + 1);
    divided.insert(divided.end(), closed.begin(), closed.end());
  }
  return divided;
}

std::vector<PlanarLoop> joinedWherePinched(std::vector<PlanarLoop> loops) {
  for (std::size_t a = 0; a < loops.size(); ++a)
    for (std::size_t b = a + 1; b < loops.size();) {
      const auto common = std::find_if(loops[a].begin(), loops[a].end(), [&](const PlanarCorner& c) {
        return positionIn(loops[b], c.point) < loops[b].size();
      });
      if (common == loops[a].end()) {
        ++b;
        continue;
      }
      auto& other = loops[b];
      std::rotate(other.begin(), other.begin() + long(positionIn(other, common->point)), other.end());
      loops[a].insert(common, other.begin(), other.end());
      loops.erase(loops.begin() + long(b));
      b = a + 1;
    }
  return loops;
}

bool isInside(const PlanarLoop& loop, FixedVector x) {
  bool inside = false;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const FixedVector a = loop[k].at, b = loop[(k + 1) % loop.size()].at;
    if ((a.v > x.v) != (b.v > x.v)) inside ^= (orientation(a, b, x) > 0) == (b.v > a.v);
  }
  return inside;
}

PlanarLoop stretch(const PlanarLoop& loop, std::size_t from, std::size_t to) {
  PlanarLoop part;
  for (std::size_t k = from;; k = (k + 1) % loop.size()) {
    part.push_back(loop[k]);
    if (k == to) return part;
  }
}

PlanarLoop withWay(const PlanarLoop& loop, const PlanarCorner& from, const PlanarCorner& to,
                   const PlanarLoop& way) {
  PlanarLoop result;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    result.push_back(loop[k]);
    if (loop[k].point != from.point || loop[(k + 1) % loop.size()].point != to.point) continue;
    for (const auto& corner : way)
      if (corner.point != from.point && corner.point != to.point) result.push_back(corner);
  }
  return result;
}

}  // namespace trimquad
