#include "trimquad/quads/disk_cells.h"

#include <algorithm>
#include <complex>
#include <set>

#include "trimquad/base/error.h"
#include "trimquad/quads/cell_merge.h"
#include "trimquad/quads/detour.h"
#include "trimquad/quads/simple_polygons.h"

namespace trimquad {
namespace {

using Side = CellMerge::Side;

/// `corner`, drawn beside from -> to, in another drawing of the two. Exact where both are charts.
FixedVector redrawn(FixedVector corner, const std::array<FixedVector, 2>& here,
                    const std::array<FixedVector, 2>& there) {
  const auto complex = [](FixedVector x) { return std::complex<double>(double(x.u), double(x.v)); };
  const auto turn = complex(there[1] - there[0]) / complex(here[1] - here[0]);
  const auto x = turn * complex(corner - here[0]);
  return there[0] + FixedVector{std::llround(x.real()), std::llround(x.imag())};
}

class DiskMaker {
 public:
  DiskMaker(QuadMesh& quads, std::vector<PlanarCell> cells) : quads_(quads), cells_(std::move(cells)) {}

  void run() {
    for (size_t k = 0; k < cells_.size(); ++k)  // more may be added
      while (!isDisk(cells_[k]) && simplePolygons(cells_[k].loops).innerEnds > 0)
        if (!leadSideThroughHole(k)) break;
    for (const auto& cell : cells_) {
      if (isDisk(cell)) continue;
      for (const auto& polygon : simplePolygons(cell.loops).polygons) {
        auto& simple = quads_.cells[cell.cell.index].simple.emplace_back();
        for (const int point : polygon) simple.push_back({point});
      }
    }
  }

 private:
  static bool isDisk(const PlanarCell& cell) {
    if (cell.loops.size() > 1) return false;
    std::vector<int> points;
    for (const auto& corner : cell.loops[0]) points.push_back(corner.point);
    std::sort(points.begin(), points.end());
    return std::adjacent_find(points.begin(), points.end()) == points.end();
  }

  bool leadSideThroughHole(size_t k) {
    if (!sides_) sides_.emplace(quads_);
    const CellId id = cells_[k].cell;
    SimpleLoops simple = dividedWherePinched(cells_[k].loops);
    auto& outer = simple.loops[0];
    std::vector<std::optional<std::vector<int>>> beyond;
    for (size_t i = 0; i < outer.size(); ++i) beyond.push_back(pointsBeyond(id, sideOf(outer, i)));
    const auto detour = shortestDetour(simple, beyond);
    if (!detour) return false;

    const Side side = sideOf(outer, detour->side);
    const std::array ends{outer[detour->side], outer[(detour->side + 1) % outer.size()]};
    const PlanarLoop& hole = simple.loops[detour->hole];
    const PlanarLoop farBank = stretch(hole, detour->entry, detour->exit),
                     nearBank = stretch(hole, detour->exit, detour->entry);
    const CellId other = sides_->across(side).value();
    PlanarLoop between = nearBank;
    between.insert(between.end(), ends.begin(), ends.end());
    moveArea(id, other, doubleArea(between), doubleArea(simple.loops));
    moveBoundary(id, other, nearBank);
    addBank(other, ends, nearBank);
    const auto touch = std::find_if(hole.begin(), hole.end(), [&](const PlanarCorner& corner) {
      return corner.inner && positionIn(outer, corner.point) < outer.size();
    });
    const std::optional<int> pinch = touch == hole.end() ? std::nullopt : std::optional(touch->point);
    outer = withWay(outer, ends[0], ends[1], farBank);
    simple.loops.erase(simple.loops.begin() + long(detour->hole));
    std::vector<PlanarLoop> apart;
    cells_[k].loops = joinedWherePinched(std::move(simple), apart);
    if (pinch) divideAt(*pinch, cells_[k].loops, apart);
    for (auto& part : apart) separate(k, std::move(part));
    setLoops(cells_[k]);
    return true;
  }

  /// Of the cell beyond a side, if that can be led elsewhere.
  std::optional<std::vector<int>> pointsBeyond(CellId cell, const Side& side) const {
    if (!sides_->isMovable(cell, side)) return {};
    std::vector<int> points;
    for (const auto& loop : quads_.cells[sides_->across(side)->index].loops)
      for (const auto point : loop) points.push_back(point.index);
    return points;
  }

  /// Where a loop comes through a point twice, `apart` gets what lies between.
  static void divideAt(int point, std::vector<PlanarLoop>& loops, std::vector<PlanarLoop>& apart) {
    const auto isThere = [&](const PlanarCorner& corner) { return corner.point == point; };
    std::vector<PlanarLoop> parts;
    for (auto* among : {&loops, &apart})
      for (auto& loop : *among) {
        const auto first = std::find_if(loop.begin(), loop.end(), isThere);
        if (first == loop.end()) continue;
        const auto second = std::find_if(first + 1, loop.end(), isThere);
        if (second == loop.end()) continue;
        parts.emplace_back(first, second);
        loop.erase(first, second);
      }
    apart.insert(apart.end(), parts.begin(), parts.end());
  }

  /// A part of a cell that has no more than a side or a point in common with the rest becomes a cell, with
  /// the holes inside it.
  void separate(size_t k, PlanarLoop part) {
    const CellId from = cells_[k].cell, id{int(quads_.cells.size())};
    quads_.cells.push_back(quads_.cells[from.index]);
    quads_.cells.back().area = 0;
    PlanarCell separated{id, {part}};
    auto& loops = cells_[k].loops;
    for (size_t l = 1; l < loops.size();) {
      if (isInside(part, loops[l][0].at)) {
        separated.loops.push_back(loops[l]);
        loops.erase(loops.begin() + long(l));
      } else {
        ++l;
      }
    }
    const WideQuanta here = doubleArea(separated.loops);
    moveArea(from, id, here, here + doubleArea(loops));
    for (const auto& loop : separated.loops) {
      for (size_t i = 0; i < loop.size(); ++i) sides_->setCell(sideOf(loop, i), id);
      PlanarLoop closed = loop;
      closed.push_back(loop[0]);
      moveBoundary(from, id, closed);
    }
    setLoops(separated);
    cells_.push_back(std::move(separated));
  }

  static Side sideOf(const PlanarLoop& loop, size_t k) {
    return {QuadPointId{loop[k].point}, QuadPointId{loop[(k + 1) % loop.size()].point}};
  }

  static WideQuanta doubleArea(const PlanarLoop& loop) { return trimquad::doubleArea(loop); }
  static WideQuanta doubleArea(const std::vector<PlanarLoop>& loops) {
    WideQuanta sum = 0;
    for (const auto& loop : loops) sum += doubleArea(loop);
    return sum;
  }

  /// What `part` is of the `whole` cell in its drawing.
  void moveArea(CellId from, CellId to, WideQuanta part, WideQuanta whole) {
    if (whole <= 0) return;  // turned over in the drawing
    const double moved = std::clamp(double(part) / double(whole), 0.0, 1.0) * quads_.cells[from.index].area;
    quads_.cells[from.index].area -= moved;
    quads_.cells[to.index].area += moved;
  }

  void moveBoundary(CellId from, CellId to, const PlanarLoop& bank) {
    std::set<Side> moved;
    for (size_t k = 0; k + 1 < bank.size(); ++k) moved.insert(sideOf(bank, k));
    for (auto& piece : quads_.boundary)
      if (piece.cell == from && moved.count({piece.from, piece.to})) piece.cell = to;
  }

  /// To the cell on the other side, in its own drawing if there is one.
  void addBank(CellId id, const std::array<PlanarCorner, 2>& ends, PlanarLoop bank) {
    const auto known =
        std::find_if(cells_.begin(), cells_.end(), [&](const auto& c) { return c.cell == id; });
    PlanarCell undrawn{id, {}};
    for (const auto& polygon : quads_.cells[id.index].loops) {
      auto& loop = undrawn.loops.emplace_back();
      for (const auto point : polygon) loop.push_back({point.index, {}});
    }
    PlanarCell& cell = known == cells_.end() ? undrawn : *known;
    for (auto& loop : cell.loops)
      for (size_t k = 0; k < loop.size(); ++k) {
        const PlanarCorner &end = loop[k], &start = loop[(k + 1) % loop.size()];
        if (end.point != ends[1].point || start.point != ends[0].point) continue;
        if (known != cells_.end())
          for (auto& corner : bank)
            corner.at = redrawn(corner.at, {ends[0].at, ends[1].at}, {start.at, end.at});
        loop = withWay(loop, end, start, bank);
        setLoops(cell);
        return;
      }
    TRIMQUAD_ASSERT(false);
  }

  void setLoops(const PlanarCell& drawn) {
    auto& cell = quads_.cells[drawn.cell.index];
    cell.full = false;
    cell.loops.clear();
    for (const auto& loop : drawn.loops) {
      auto& polygon = cell.loops.emplace_back();
      for (const auto& corner : loop) polygon.push_back({corner.point});
    }
  }

  QuadMesh& quads_;
  std::optional<CellMerge> sides_;  // a side that was led elsewhere occurs no more
  std::vector<PlanarCell> cells_;
};

}  // namespace

void makeDisks(QuadMesh& quads, std::vector<PlanarCell> cells) {
  DiskMaker(quads, std::move(cells)).run();
}

}  // namespace trimquad
