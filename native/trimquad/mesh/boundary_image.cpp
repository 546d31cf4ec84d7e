#include "trimquad/mesh/boundary_image.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

/// A segment moved by whole periods into the strip that is looked at.
struct Copy {
  FixedVector from, to;
  int segment;
};

bool onSegment(FixedVector a, FixedVector b, FixedVector p) {
  return std::min(a.u, b.u) <= p.u && p.u <= std::max(a.u, b.u) && std::min(a.v, b.v) <= p.v &&
         p.v <= std::max(a.v, b.v);
}

bool meet(const Copy& a, const Copy& b) {
  const int o1 = orientation(a.from, a.to, b.from), o2 = orientation(a.from, a.to, b.to);
  const int o3 = orientation(b.from, b.to, a.from), o4 = orientation(b.from, b.to, a.to);
  if (o1 * o2 < 0 && o3 * o4 < 0) return true;
  return (o1 == 0 && onSegment(a.from, a.to, b.from)) || (o2 == 0 && onSegment(a.from, a.to, b.to)) ||
         (o3 == 0 && onSegment(b.from, b.to, a.from)) || (o4 == 0 && onSegment(b.from, b.to, a.to));
}

/// Neighbours in a loop share their joint; they have more in common only if the second runs back along the
/// first.
bool foldBack(const Copy& a, const Copy& b) {
  const FixedVector x = a.to - a.from, y = b.to - b.from;
  return cross(x, y) == 0 && dot(x, y) < 0;
}

std::vector<Copy> copiesInStrip(const std::vector<BoundarySegment>& segments, std::optional<Quanta> period) {
  std::vector<Copy> copies;
  for (int i = 0; i < int(segments.size()); ++i) {
    const auto& s = segments[i];
    if (!period) {
      copies.push_back({s.from, s.to, i});
      continue;
    }
    const auto floorDivide = [&](Quanta x) { return x / *period - (x % *period < 0); };
    const Quanta low = floorDivide(std::min(s.from.u, s.to.u)),
                 high = floorDivide(std::max(s.from.u, s.to.u));
    // Every copy that touches [0, period]; a point of the line u = 0 then meets its image on u = period as
    // well.
    for (Quanta k = low - 1; k <= high; ++k) {
      const FixedVector shift{-k * *period, 0};
      const Copy c{s.from + shift, s.to + shift, i};
      if (std::max(c.from.u, c.to.u) >= 0 && std::min(c.from.u, c.to.u) <= *period) copies.push_back(c);
    }
  }
  return copies;
}

struct CellEntry {
  std::int64_t column, row;
  int copy;
  friend auto operator<=>(const CellEntry&, const CellEntry&) = default;
};

/// The cells of a square grid that the copies pass, with a margin that covers rounding. Sorted.
std::vector<CellEntry> cellsPassed(const std::vector<Copy>& copies) {
  double extent = 0;
  for (const auto& c : copies)
    extent += double(std::max(std::abs(c.to.u - c.from.u), std::abs(c.to.v - c.from.v)));
  const double cell = std::max(1.0, 2 * extent / double(copies.size()));
  std::vector<CellEntry> entries;
  for (int i = 0; i < int(copies.size()); ++i) {
    FixedVector a = copies[i].from, b = copies[i].to;
    if (a.u > b.u) std::swap(a, b);
    const auto columnOf = [&](double u) { return std::int64_t(std::floor(u / cell)); };
    const double slope = b.u > a.u ? double(b.v - a.v) / double(b.u - a.u) : 0;
    for (auto column = columnOf(double(a.u) - 1); column <= columnOf(double(b.u) + 1); ++column) {
      double low = double(std::min(a.v, b.v)), high = double(std::max(a.v, b.v));
      if (b.u > a.u) {
        const double left = std::max(double(a.u), cell * double(column)),
                     right = std::min(double(b.u), cell * double(column + 1));
        const double atLeft = double(a.v) + slope * (left - double(a.u)),
                     atRight = double(a.v) + slope * (right - double(a.u));
        low = std::max(low, std::min(atLeft, atRight) - 1e-6 * cell);
        high = std::min(high, std::max(atLeft, atRight) + 1e-6 * cell);
      }
      for (auto row = columnOf(low - 1); row <= columnOf(high + 1); ++row)
        entries.push_back({column, row, i});
    }
  }
  std::sort(entries.begin(), entries.end());
  return entries;
}

}  // namespace

std::optional<std::pair<int, int>> firstContact(const std::vector<BoundarySegment>& segments,
                                                std::optional<Quanta> period) {
  if (segments.empty()) return {};
  const auto copies = copiesInStrip(segments, period);
  const auto entries = cellsPassed(copies);
  std::optional<std::pair<int, int>> first;
  for (size_t begin = 0, end = 0; begin < entries.size(); begin = end) {
    while (end < entries.size() && entries[end].column == entries[begin].column &&
           entries[end].row == entries[begin].row)
      ++end;
    for (size_t x = begin; x < end; ++x)
      for (size_t y = x + 1; y < end; ++y) {
        const Copy &a = copies[entries[x].copy], &b = copies[entries[y].copy];
        const bool ab = segments[a.segment].next == b.segment && a.to == b.from;
        const bool ba = segments[b.segment].next == a.segment && b.to == a.from;
        const bool contact = ab ? foldBack(a, b) : ba ? foldBack(b, a) : meet(a, b);
        if (!contact) continue;
        const auto pair = std::minmax(a.segment, b.segment);
        if (!first || std::pair<int, int>(pair) < *first) first = pair;
      }
  }
  return first;
}

}  // namespace trimquad
