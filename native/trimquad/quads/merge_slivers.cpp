#include "trimquad/quads/merge_slivers.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

using Side = std::array<QuadPointId, 2>;  // in the direction of the cell to its left

Side reversed(const Side& side) {
  return {side[1], side[0]};
}

class SliverMerge {
 public:
  SliverMerge(QuadMesh& quads, double fraction)
      : quads_(quads),
        fraction_(fraction),
        mergedInto_(quads.cells.size()),
        feature_(quads.featureEdges.begin(), quads.featureEdges.end()) {
    for (int c = 0; c < int(quads_.cells.size()); ++c) {
      for (const auto& side : sidesOf(c))
        if (!cellAt_.emplace(side, c).second) doubled_.insert(side);
      addIfSliver(c);
    }
  }

  int run() {
    int merged = 0;
    while (!slivers_.empty()) {
      const int sliver = slivers_.begin()->second;
      slivers_.erase(slivers_.begin());
      if (const auto side = sideToRemove(sliver)) {
        merge(sliver, *side);
        ++merged;
      }
    }
    if (merged > 0) compact();
    return merged;
  }

 private:
  std::vector<Side> sidesOf(int cell) const {
    std::vector<Side> sides;
    for (const auto& loop : quads_.cells[cell].loops)
      for (size_t k = 0; k < loop.size(); ++k) sides.push_back({loop[k], loop[(k + 1) % loop.size()]});
    return sides;
  }

  std::set<QuadPointId> pointsOf(int cell) const {
    std::set<QuadPointId> points;
    for (const auto& loop : quads_.cells[cell].loops) points.insert(loop.begin(), loop.end());
    return points;
  }

  void addIfSliver(int cell) {
    const auto& c = quads_.cells[cell];
    if (!c.full && c.area < fraction_ && c.loops.size() == 1 && c.simple.empty())
      slivers_.insert({c.area, cell});
  }

  std::optional<Side> sideToRemove(int sliver) const {
    const auto points = pointsOf(sliver);
    std::optional<Side> best;
    double longest = -1;
    for (const auto& side : sidesOf(sliver)) {
      const double length =
          (quads_.points[side[1].index].position - quads_.points[side[0].index].position).norm();
      if (length > longest && isRemovable(sliver, side, points)) best = side, longest = length;
    }
    return best;
  }

  /// Whether the cells to both sides have nothing else in common.
  bool isRemovable(int sliver, const Side& side, const std::set<QuadPointId>& points) const {
    const auto across = cellAt_.find(reversed(side));
    if (across == cellAt_.end() || across->second == sliver) return false;
    if (doubled_.count(side) || doubled_.count(reversed(side))) return false;
    if (feature_.count(side) || feature_.count(reversed(side))) return false;
    const auto others = pointsOf(across->second);
    return std::count_if(points.begin(), points.end(), [&](QuadPointId p) { return others.count(p) > 0; }) ==
           2;
  }

  void merge(int sliver, const Side& side) {
    const int into = cellAt_.at(reversed(side));
    for (const auto& s : sidesOf(sliver)) cellAt_[s] = into;
    cellAt_.erase(side);
    cellAt_.erase(reversed(side));
    auto& cell = quads_.cells[into];
    const auto& loop = quads_.cells[sliver].loops[0];
    const bool inLoops = replaceSide(cell.loops, reversed(side), loop);
    const bool inSimple = cell.simple.empty() || replaceSide(cell.simple, reversed(side), loop);
    TRIMQUAD_ASSERT(inLoops && inSimple);
    slivers_.erase({cell.area, into});
    cell.area += quads_.cells[sliver].area;
    cell.full = false;
    mergedInto_[sliver] = into;
    addIfSliver(into);
  }

  /// Puts what the loop has beside the reversed side in the place of the side.
  static bool replaceSide(std::vector<QuadMesh::Polygon>& polygons, const Side& side,
                          const QuadMesh::Polygon& loop) {
    const auto start = std::find(loop.begin(), loop.end(), side[0]);  // the loop comes here from side[1]
    QuadMesh::Polygon detour(start + 1, loop.end());
    detour.insert(detour.end(), loop.begin(), start);
    detour.pop_back();
    for (auto& polygon : polygons)
      for (size_t k = 0; k < polygon.size(); ++k)
        if (polygon[k] == side[0] && polygon[(k + 1) % polygon.size()] == side[1]) {
          polygon.insert(polygon.begin() + long(k) + 1, detour.begin(), detour.end());
          return true;
        }
    return false;
  }

  void compact() {
    std::vector<CellId> number;
    std::vector<QuadMesh::Cell> cells;
    for (size_t c = 0; c < quads_.cells.size(); ++c) {
      number.push_back({int(cells.size())});
      if (!mergedInto_[c]) cells.push_back(std::move(quads_.cells[c]));
    }
    quads_.cells = std::move(cells);
    for (auto& piece : quads_.boundary) {
      int cell = piece.cell.index;
      while (mergedInto_[cell]) cell = *mergedInto_[cell];
      piece.cell = number[cell];
    }
    std::vector<bool> crossed(quads_.points.size(), false);
    for (const auto& [side, cell] : cellAt_)
      if (cellAt_.count(reversed(side))) crossed[side[0].index] = true;
    for (size_t p = 0; p < crossed.size(); ++p)
      if (quads_.points[p].kind == QuadMesh::PointKind::Crossing && !crossed[p])
        quads_.points[p].kind = QuadMesh::PointKind::Boundary;
  }

  QuadMesh& quads_;
  const double fraction_;
  std::vector<std::optional<int>> mergedInto_;  ///< by cell
  const std::set<Side> feature_;
  std::map<Side, int> cellAt_;  ///< the cell to the left
  std::set<Side> doubled_;      ///< sides that several cells have
  std::set<std::pair<double, int>> slivers_;
};

}  // namespace

int mergeSlivers(QuadMesh& quads, double fraction) {
  const int merged = SliverMerge(quads, fraction).run();
  quads.mergedSlivers += merged;
  return merged;
}

}  // namespace trimquad
