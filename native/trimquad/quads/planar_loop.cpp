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

namespace {

/// Takes spurs out of a loop until it has none; its parts are loops.
void divideAlongSpurs(PlanarLoop loop, SimpleLoops& simple, std::vector<PlanarLoop>& parts) {
  const std::size_t n = loop.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j) {
      if (loop[i].point != loop[(j + 1) % n].point || loop[i + 1].point != loop[j].point) continue;
      if (j < i + 4 || n < j - i + 4) continue;  // one of the parts is no polygon
      simple.spurs.push_back({loop[i], loop[j]});
      const PlanarLoop beyond(loop.begin() + long(i) + 1, loop.begin() + long(j));
      loop.erase(loop.begin() + long(i) + 1, loop.begin() + long(j) + 1);
      loop.erase(loop.begin() + long((i + 1) % loop.size()));  // where the way back ends
      divideAlongSpurs(std::move(loop), simple, parts);
      return divideAlongSpurs(beyond, simple, parts);
    }
  parts.push_back(std::move(loop));
}

void divideAtPoints(const PlanarLoop& loop, std::vector<PlanarLoop>& parts) {
  PlanarLoop open;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const PlanarCorner& corner = loop[k];
    const std::size_t before = positionIn(open, corner.point);
    const bool polygons = open.size() >= before + 3 && before + loop.size() - k >= 3;
    if (before < open.size() && (!corner.inner || polygons)) {
      parts.emplace_back(open.begin() + long(before), open.end());
      open.resize(before);
    }
    open.push_back(corner);
  }
  parts.push_back(std::move(open));
}

}  // namespace

SimpleLoops dividedWherePinched(const std::vector<PlanarLoop>& loops) {
  SimpleLoops simple;
  std::vector<PlanarLoop> parts;
  for (const auto& loop : loops) divideAlongSpurs(loop, simple, parts);
  for (const auto& part : parts) divideAtPoints(part, simple.loops);
  const auto outer =
      std::max_element(simple.loops.begin(), simple.loops.end(),
                       [](const auto& a, const auto& b) { return doubleArea(a) < doubleArea(b); });
  std::rotate(simple.loops.begin(), outer, outer + 1);
  return simple;
}

std::vector<PlanarLoop> joinedWherePinched(SimpleLoops simple, std::vector<PlanarLoop>& apart) {
  auto& loops = simple.loops;
  // b comes into a behind the corner, with what leads there and back.
  const auto join = [&](std::size_t a, std::size_t corner, std::size_t b, std::size_t start, bool bySpur) {
    std::rotate(loops[b].begin(), loops[b].begin() + long(start), loops[b].end());
    PlanarLoop detour = loops[b];
    if (bySpur) detour.push_back(detour.front()), detour.push_back(loops[a][corner]);
    if (!bySpur) std::rotate(detour.begin(), detour.begin() + 1, detour.end());
    loops[a].insert(loops[a].begin() + long(corner) + 1, detour.begin(), detour.end());
    loops.erase(loops.begin() + long(b));
  };
  for (const auto& spur : simple.spurs)
    for (std::size_t a = 0; a < loops.size(); ++a) {
      std::size_t i = positionIn(loops[a], spur[0].point), j = positionIn(loops[a], spur[1].point);
      if (i == loops[a].size() && j == loops[a].size()) continue;
      if (i < loops[a].size() && j < loops[a].size()) {
        apart.push_back(stretch(loops[a], i, j));
        loops[a] = stretch(loops[a], j, i);
        break;
      }
      const int here = i < loops[a].size() ? 0 : 1;
      for (std::size_t b = a + 1; b < loops.size(); ++b) {
        const std::size_t there = positionIn(loops[b], spur[1 - here].point);
        if (there == loops[b].size()) continue;
        join(a, here == 0 ? i : j, b, there, true);
        break;
      }
      break;
    }
  for (std::size_t a = 0; a < loops.size(); ++a)
    for (std::size_t b = a + 1; b < loops.size();) {
      std::size_t corner = 0, start = loops[b].size();
      for (; corner < loops[a].size(); ++corner)
        if ((start = positionIn(loops[b], loops[a][corner].point)) < loops[b].size()) break;
      if (corner == loops[a].size()) {
        ++b;
        continue;
      }
      join(a, corner, b, start, false);
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
