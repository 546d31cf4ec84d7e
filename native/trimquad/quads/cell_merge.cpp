#include "trimquad/quads/cell_merge.h"

#include <algorithm>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

using Polygon = QuadMesh::Polygon;
using Side = CellMerge::Side;

/// Puts what the loop has beside the reversed side in the place of the side.
bool replaceSide(std::vector<Polygon>& polygons, const Side& side, const Polygon& loop) {
  const auto start = std::find(loop.begin(), loop.end(), side[0]);  // the loop comes here from side[1]
  Polygon detour(start + 1, loop.end());
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

bool contains(const Polygon& polygon, QuadPointId point) {
  return std::find(polygon.begin(), polygon.end(), point) != polygon.end();
}

void rename(std::vector<Polygon>& polygons, QuadPointId from, QuadPointId to) {
  for (auto& polygon : polygons) {
    if (!contains(polygon, from)) continue;
    if (contains(polygon, to))
      std::erase(polygon, from);
    else
      std::replace(polygon.begin(), polygon.end(), from, to);
  }
}

}  // namespace

CellMerge::CellMerge(QuadMesh& quads)
    : quads_(quads),
      mergedInto_(quads.cells.size()),
      feature_(quads.featureEdges.begin(), quads.featureEdges.end()) {
  for (int c = 0; c < int(quads_.cells.size()); ++c)
    for (const auto& side : sidesOf({c}))
      if (!cellAt_.emplace(side, CellId{c}).second) doubled_.insert(side);
}

std::vector<Side> CellMerge::sidesOf(CellId cell) const {
  std::vector<Side> sides;
  for (const auto& loop : quads_.cells[cell.index].loops)
    for (size_t k = 0; k < loop.size(); ++k) sides.push_back({loop[k], loop[(k + 1) % loop.size()]});
  return sides;
}

std::optional<CellId> CellMerge::across(const Side& side) const {
  const auto found = cellAt_.find(reversed(side));
  return found == cellAt_.end() ? std::nullopt : std::optional(found->second);
}

std::set<QuadPointId> CellMerge::pointsOf(CellId cell) const {
  std::set<QuadPointId> points;
  for (const auto& loop : quads_.cells[cell.index].loops) points.insert(loop.begin(), loop.end());
  return points;
}

std::vector<CellId> CellMerge::cellsAround(QuadPointId point) const {
  std::vector<CellId> cells;
  for (auto it = cellAt_.lower_bound({point, {0}}); it != cellAt_.end() && it->first[0] == point; ++it)
    cells.push_back(it->second);
  return cells;
}

std::optional<Side> CellMerge::mergeableSide(CellId cell) const {
  std::optional<Side> best;
  double longest = -1;
  for (const auto& side : sidesOf(cell)) {
    const double length = ((*this)[side[1]].position - (*this)[side[0]].position).norm();
    if (length > longest && isMergeable(cell, side)) best = side, longest = length;
  }
  return best;
}

bool CellMerge::isMovable(CellId cell, const Side& side) const {
  const auto other = across(side);
  return other && *other != cell && !isFeature(side) && !doubled_.count(side) &&
         !doubled_.count(reversed(side));
}

bool CellMerge::isMergeable(CellId cell, const Side& side) const {
  if (!isMovable(cell, side)) return false;
  const auto points = pointsOf(cell), others = pointsOf(across(side).value());
  return std::count_if(points.begin(), points.end(), [&](QuadPointId p) { return others.count(p) > 0; }) == 2;
}

void CellMerge::merge(CellId cell, const Side& side) {
  const CellId into = across(side).value();
  for (const auto& s : sidesOf(cell)) cellAt_[s] = into;
  cellAt_.erase(side);
  cellAt_.erase(reversed(side));
  auto &merged = quads_.cells[into.index], &gone = quads_.cells[cell.index];
  const bool inLoops = replaceSide(merged.loops, reversed(side), gone.loops[0]);
  const bool inSimple = merged.simple.empty() || replaceSide(merged.simple, reversed(side), gone.loops[0]);
  TRIMQUAD_ASSERT(inLoops && inSimple);
  merged.area += gone.area;
  merged.full = false;
  mergedInto_[cell.index] = into;
}

bool CellMerge::isCollapsible(const Side& side, const std::vector<CellId>& merged) const {
  const auto [point, into] = side;
  if ((*this)[point].border || !(*this)[into].border || isFeature(side)) return false;
  if (!cellAt_.count(side) || !cellAt_.count(reversed(side))) return false;
  int beside = 0;
  for (const CellId id : cellsAround(point)) {
    const auto& cell = (*this)[id];
    for (const auto& s : sidesOf(id))
      if (doubled_.count(s) || doubled_.count(reversed(s))) return false;
    if (!cell.simple.empty()) return false;
    if (!pointsOf(id).count(into)) continue;
    ++beside;
    if (std::find(merged.begin(), merged.end(), id) == merged.end() && cell.loops[0].size() < 4) return false;
  }
  return beside == 2;
}

void CellMerge::collapse(const Side& side) {
  const auto [point, into] = side;
  for (const CellId id : cellsAround(point)) {
    for (const auto& s : sidesOf(id)) cellAt_.erase(s);
    auto& cell = quads_.cells[id.index];
    rename(cell.loops, point, into);
    rename(cell.simple, point, into);
    for (const auto& s : sidesOf(id)) cellAt_[s] = id;
  }
  std::set<Side> renamed;
  for (Side s : feature_) {
    std::replace(s.begin(), s.end(), point, into);
    renamed.insert({std::min(s[0], s[1]), std::max(s[0], s[1])});
  }
  feature_ = std::move(renamed);
  auto& kind = quads_.points[into.index].kind;
  if (kind != QuadMesh::PointKind::Corner) kind = QuadMesh::PointKind::Grid;
}

void CellMerge::markWhole(CellId cell) {
  auto& whole = quads_.cells[cell.index];
  TRIMQUAD_ASSERT(whole.loops.size() == 1 && whole.loops[0].size() == 4);
  whole.full = true;
  whole.area = 1;
}

void CellMerge::finish() {
  quads_.featureEdges.assign(feature_.begin(), feature_.end());
  dropMergedCells();
  updateKinds();
  dropUnusedPoints();
}

void CellMerge::dropMergedCells() {
  std::vector<CellId> number;
  std::vector<QuadMesh::Cell> cells;
  for (size_t c = 0; c < quads_.cells.size(); ++c) {
    number.push_back({int(cells.size())});
    if (!mergedInto_[c]) cells.push_back(std::move(quads_.cells[c]));
  }
  for (auto& piece : quads_.boundary) {
    CellId cell = piece.cell;
    while (mergedInto_[cell.index]) cell = *mergedInto_[cell.index];
    piece.cell = number[cell.index];
  }
  quads_.cells = std::move(cells);
}

/// Where no grid line ends on the boundary any more, there is no crossing.
void CellMerge::updateKinds() {
  std::vector<bool> crossed(quads_.points.size(), false);
  for (const auto& [side, cell] : cellAt_)
    if (cellAt_.count(reversed(side))) crossed[side[0].index] = true;
  for (size_t p = 0; p < crossed.size(); ++p)
    if (quads_.points[p].kind == QuadMesh::PointKind::Crossing && !crossed[p])
      quads_.points[p].kind = QuadMesh::PointKind::Boundary;
}

void CellMerge::dropUnusedPoints() {
  std::vector<bool> used(quads_.points.size(), false);
  for (const auto& cell : quads_.cells)
    for (const auto& loop : cell.loops)
      for (const auto id : loop) used[id.index] = true;
  std::vector<int> number;
  std::vector<QuadMesh::Point> points;
  for (size_t p = 0; p < used.size(); ++p) {
    number.push_back(int(points.size()));
    if (used[p]) points.push_back(quads_.points[p]);
  }
  quads_.points = std::move(points);
  const auto renumber = [&](QuadPointId& id) { id.index = number[id.index]; };
  for (auto& cell : quads_.cells)
    for (auto* polygons : {&cell.loops, &cell.simple})
      for (auto& polygon : *polygons) std::for_each(polygon.begin(), polygon.end(), renumber);
  for (auto& piece : quads_.boundary) renumber(piece.from), renumber(piece.to);
  for (auto& side : quads_.featureEdges) renumber(side[0]), renumber(side[1]);
}

}  // namespace trimquad
