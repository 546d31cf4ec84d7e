#include "trimquad/quads/merge_slivers.h"

#include <algorithm>
#include <set>

#include "trimquad/quads/cell_merge.h"

namespace trimquad {
namespace {

using Side = CellMerge::Side;

/// Area of a cell that vanishes, as a fraction of a whole one.
constexpr double kVanishing = 1e-6;
/// Distance of a cell's corners from a line, as a fraction of its length, up to which they lie on it.
constexpr double kStraight = 1e-9;

bool isTrimmedPolygon(const QuadMesh::Cell& cell) {
  return !cell.full && cell.loops.size() == 1 && cell.simple.empty();
}

bool isSliver(const QuadMesh::Cell& cell, double fraction) {
  return cell.area < fraction && isTrimmedPolygon(cell);
}

/// Whether a cell's corners lie on one line in space, on the boundary: this is straight there though the map
/// bends it.
bool isStraight(const CellMerge& cells, CellId id) {
  const auto& cell = cells[id];
  if (!isTrimmedPolygon(cell)) return false;
  const auto& loop = cell.loops[0];
  const Eigen::Vector3d origin = cells[loop[0]].position;
  Eigen::Vector3d line = Eigen::Vector3d::Zero();
  for (const auto point : loop) {
    const Eigen::Vector3d x = cells[point].position - origin;
    if (!cells[point].border) return false;
    if (x.squaredNorm() > line.squaredNorm()) line = x;
  }
  return std::all_of(loop.begin(), loop.end(), [&](QuadPointId point) {
    return (cells[point].position - origin).cross(line).norm() <= kStraight * line.squaredNorm();
  });
}

double length(const CellMerge& cells, const Side& side) {
  return (cells[side[1]].position - cells[side[0]].position).norm();
}

/// How a vanishing cell goes.
struct Drop {
  std::vector<std::pair<CellId, Side>>
      merges;              ///< it, and triangles beside it of which nothing would be left
  std::vector<Side> ways;  ///< of grid points to the boundary

  /// Whether it can go across a side. Its inner ends take its other sides there to the boundary.
  static std::optional<Drop> across(const CellMerge& cells, CellId cell, const Side& removed) {
    Drop drop;
    drop.merges.push_back({cell, removed});
    for (const auto& side : cells.sidesOf(cell))
      for (const auto& way : {side, CellMerge::reversed(side)}) {
        const bool fromEnd = way[0] == removed[0] || way[0] == removed[1];
        const bool isRemoved = fromEnd && (way[1] == removed[0] || way[1] == removed[1]);
        if (!fromEnd || isRemoved || cells[way[0]].border) continue;
        if (!drop.add(cells, cell, way)) return {};
      }
    std::vector<CellId> into;
    for (const auto& [gone, side] : drop.merges) into.push_back(cells.across(side).value());
    std::sort(into.begin(), into.end());
    const bool distinct = std::adjacent_find(into.begin(), into.end()) == into.end();
    if (!distinct || (drop.ways.size() == 2 && drop.ways[0][1] == drop.ways[1][1])) return {};
    return drop;
  }

 private:
  bool add(const CellMerge& cells, CellId cell, const Side& way) {
    if (cells[way[0]].quads != 4 || length(cells, way) > length(cells, merges[0].second)) return false;
    const auto left = cells.across(CellMerge::reversed(way)), right = cells.across(way);
    if (!left || !right) return false;
    const CellId beside = *left == cell ? *right : *left;
    if (beside == cell || beside == cells.across(merges[0].second)) return false;
    for (const auto& [gone, side] : merges)
      if (gone == beside || cells.across(side) == beside) return false;
    std::vector<CellId> merged{cell};
    if (isSliver(cells[beside], kVanishing) && cells[beside].loops[0].size() == 3) {
      const auto sides = cells.sidesOf(beside);
      const auto side = std::find_if(sides.begin(), sides.end(), [&](const Side& s) {
        return std::count(s.begin(), s.end(), way[0]) == 1 && std::count(s.begin(), s.end(), way[1]) == 0;
      });
      if (side == sides.end() || !cells.isMergeable(beside, *side)) return false;
      merges.push_back({beside, *side});
      merged.push_back(beside);
    }
    ways.push_back(way);
    return cells.isCollapsible(way, merged);
  }
};

}  // namespace

int mergeSlivers(QuadMesh& quads, double fraction) {
  CellMerge cells(quads);
  std::set<std::pair<double, CellId>> slivers;
  const auto addIfSliver = [&](CellId id) {
    if (isSliver(cells[id], fraction)) slivers.insert({cells[id].area, id});
  };
  for (int c = 0; c < int(quads.cells.size()); ++c) addIfSliver({c});
  int merged = 0;
  while (!slivers.empty()) {
    const CellId sliver = slivers.begin()->second;
    slivers.erase(slivers.begin());
    const auto side = cells.mergeableSide(sliver);
    if (!side) continue;
    const CellId into = cells.across(*side).value();
    slivers.erase({cells[into].area, into});
    cells.merge(sliver, *side);
    addIfSliver(into);
    ++merged;
  }
  if (merged > 0) cells.finish();
  quads.mergedSlivers += merged;
  return merged;
}

int dropVanishingCells(QuadMesh& quads) {
  CellMerge cells(quads);
  int dropped = 0;
  for (int c = 0; c < int(quads.cells.size()); ++c) {
    const CellId cell{c};
    if (cells.isGone(cell) || !(isSliver(cells[cell], kVanishing) || isStraight(cells, cell))) continue;
    const auto side = cells.mergeableSide(cell);
    const auto drop = side ? Drop::across(cells, cell, *side) : std::nullopt;
    if (!drop) continue;
    std::vector<CellId> whole;
    for (const auto& [gone, removed] : drop->merges) {
      const CellId into = cells.across(removed).value();
      if (cells[into].full) whole.push_back(into);
      cells.merge(gone, removed);
      ++dropped;
    }
    for (const auto& way : drop->ways) cells.collapse(way);
    for (const CellId id : whole)
      if (cells[id].loops[0].size() == 4) cells.markWhole(id);
  }
  if (dropped > 0) cells.finish();
  quads.droppedSlivers += dropped;
  return dropped;
}

}  // namespace trimquad
