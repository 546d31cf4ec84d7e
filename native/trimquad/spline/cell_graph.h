#pragma once

#include <vector>

#include "trimquad/quads/grid_overlay.h"

namespace trimquad {

/// The cells of a grid map, whole and trimmed, each in a plane of its own, and how they are glued together
/// across grid lines. Exact.
class CellGraph {
 public:
  /// Throws Error(Stage, "fit") where a cell winds around a hole in which the charts do not agree.
  CellGraph(const Parametrization& map, const Progress& progress);

  const Parametrization& map() const { return map_; }
  const GridOverlay& overlay() const { return overlay_; }

  int size() const { return int(piecesOf_.size()); }
  int cellOfPiece(int piece) const { return cellOfPiece_[piece]; }
  const std::vector<int>& pieces(int cell) const { return piecesOf_[cell]; }
  int halfedgeOf(int piece) const { return some_[piece]; }  ///< one of its halfedges
  /// From the chart of the piece's triangle to the plane of its cell.
  const Transition& toCell(int piece) const { return toCell_[piece]; }

  /// Halfedges of the overlay on grid lines with another cell (or the same one) on the other side.
  const std::vector<int>& sides(int cell) const { return sides_[cell]; }
  int cellAt(int halfedge) const { return cellOfPiece_[overlay_.halfedges[halfedge].piece]; }
  int cellAcross(int halfedge) const { return cellAt(halfedge ^ 1); }
  /// From the plane of the cell across a side to the plane of the cell that has the side.
  Transition fromAcross(int halfedge) const;
  /// From the chart of the triangle across a halfedge of the overlay to the chart of the triangle that has
  /// it.
  Transition acrossTriangles(int halfedge) const;
  /// Whether the side lies on an aligned edge inside the surface.
  bool isFeature(int halfedge) const;

  /// Position on the doubled grid (2k: on line k, 2k + 1: between k and k + 1) of the cell in its plane.
  FixedVector place(int cell) const;
  /// The same of a position in quanta that lies on the grid.
  FixedVector place(FixedVector x) const;
  /// A transition between planes as it acts on the doubled grid.
  FixedVector moved(const Transition& t, FixedVector place) const;

  /// The next halfedge on a grid line, or on the boundary, clockwise around the point that `halfedge` leaves;
  /// negative where the surface ends before.
  int nextClockwise(int halfedge) const;
  /// Quarter turns around an interior point of the overlay on the grid; 0 on the boundary.
  int quarters(int point) const;

 private:
  void joinPieces();
  void unrollCells();

  const Parametrization& map_;
  GridOverlay overlay_;
  std::vector<int> cone_, cellOfPiece_, some_;
  std::vector<std::vector<int>> piecesOf_, sides_;
  std::vector<Transition> toCell_;
  std::vector<char> aligned_;
};

}  // namespace trimquad
