#include "trimquad/spline/chart_cells.h"

#include <algorithm>
#include <map>

namespace trimquad {
namespace {

/// A part of a grid line, along its axis, quanta.
struct Interval {
  Quanta low, high;
  int edge, cell;
};

struct PlacedPoint {
  int point, cell;
};

/// The piece's corners in the chart, counter-clockwise.
std::vector<FixedVector> corners(const CellGraph& graph, int piece, int start, const Transition& toChart) {
  const auto& overlay = graph.overlay();
  const Transition t = toChart.after(graph.toCell(piece));
  std::vector<FixedVector> result;
  int h = start;
  do {
    result.push_back(t(overlay.halfedges[h].at));
    h = overlay.halfedges[h].next;
  } while (h != start);
  return result;
}

/// Whether a side of `a` has all of `b` strictly beyond it.
bool separated(const std::vector<FixedVector>& a, const std::vector<FixedVector>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    const FixedVector p = a[i], q = a[(i + 1) % a.size()];
    if (p == q) continue;
    if (std::all_of(b.begin(), b.end(), [&](FixedVector x) { return orientation(p, q, x) < 0; })) return true;
  }
  return false;
}

class Placement {
 public:
  Placement(const CellGraph& graph, const std::vector<PlacedCell>& cells) : graph_(graph), cells_(cells) {
    for (int i = 0; i < int(cells.size()); ++i) indexOf_[cells[i].cell] = i;
  }

  std::optional<std::pair<int, int>> conflict() {
    for (const auto& placed : cells_) {
      for (const int h : graph_.sides(placed.cell)) {
        const int other = graph_.cellAcross(h);
        const auto found = indexOf_.find(other);
        if (found == indexOf_.end()) continue;
        const Transition there = placed.toChart.after(graph_.fromAcross(h));
        if (graph_.isFeature(h) || !(there == cells_[found->second].toChart))
          return std::pair(placed.cell, other);
      }
      if (const auto other = clashOfCell(placed)) return std::pair(placed.cell, *other);
    }
    return {};
  }

 private:
  std::optional<int> clashOfCell(const PlacedCell& placed) {
    auto& here = cellsAt_[graph_.moved(placed.toChart, graph_.place(placed.cell))];
    for (const int other : here)
      if (overlap(placed, cells_[indexOf_.at(other)])) return other;
    here.push_back(placed.cell);
    const auto& overlay = graph_.overlay();
    for (const int piece : graph_.pieces(placed.cell)) {
      const Transition t = placed.toChart.after(graph_.toCell(piece));
      const int start = someHalfedge(piece);
      int h = start;
      do {
        const auto& half = overlay.halfedges[h];
        const FixedVector at = t(half.at);
        if (overlay.points[half.origin].integer) {
          const auto [it, isNew] = pointAt_.try_emplace(at, PlacedPoint{half.origin, placed.cell});
          if (!isNew && it->second.point != half.origin) return it->second.cell;
        }
        if (overlay.edges[h >> 1].grid)
          if (const auto other = clashOfSide(h, at, t(overlay.halfedges[half.next].at), placed.cell))
            return other;
        h = half.next;
      } while (h != start);
    }
    return {};
  }

  std::optional<int> clashOfSide(int h, FixedVector from, FixedVector to, int cell) {
    const int axis = from.u == to.u ? 1 : 0;
    const FixedVector middle{(from.u + to.u) / 2, (from.v + to.v) / 2};
    FixedVector place = graph_.place(middle);
    // The middle of a stretch between two grid points may round to one of these.
    if (place[axis] % 2 == 0)
      (axis == 0 ? place.u : place.v) += middle[axis] < std::max(from[axis], to[axis]) ? 1 : -1;
    auto& here = sidesAt_[place];
    const Interval mine{std::min(from[axis], to[axis]), std::max(from[axis], to[axis]), h >> 1, cell};
    for (const auto& other : here)
      if (other.edge != mine.edge && other.cell != cell && other.low <= mine.high && mine.low <= other.high &&
          !glued(h, other.cell))
        return other.cell;
    here.push_back(mine);
    return {};
  }

  /// Whether the surface goes on from the side into that cell.
  bool glued(int h, int cell) const {
    return !graph_.overlay().edges[h >> 1].border && graph_.cellAcross(h) == cell;
  }

  bool overlap(const PlacedCell& a, const PlacedCell& b) {
    for (const int p : graph_.pieces(a.cell)) {
      const auto polygon = corners(graph_, p, someHalfedge(p), a.toChart);
      for (const int q : graph_.pieces(b.cell)) {
        const auto other = corners(graph_, q, someHalfedge(q), b.toChart);
        if (!separated(polygon, other) && !separated(other, polygon)) return true;
      }
    }
    return false;
  }

  int someHalfedge(int piece) const { return graph_.halfedgeOf(piece); }

  const CellGraph& graph_;
  const std::vector<PlacedCell>& cells_;
  std::map<int, int> indexOf_;
  std::map<FixedVector, std::vector<int>> cellsAt_;
  std::map<FixedVector, PlacedPoint> pointAt_;
  std::map<FixedVector, std::vector<Interval>> sidesAt_;
};

}  // namespace

std::optional<std::pair<int, int>> conflict(const CellGraph& graph, const std::vector<PlacedCell>& cells) {
  return Placement(graph, cells).conflict();
}

}  // namespace trimquad
