#pragma once

#include <optional>
#include <vector>

#include "trimquad/quads/grid_overlay.h"

namespace trimquad {

/// A point of a cell's border, before it is decided which vertices of the surface's boundary the cell keeps.
struct LoopPoint {
  int halfedge;    ///< of the overlay, leaves the point
  FixedVector at;  ///< in the chart in which the loop starts
  bool kept;       ///< is a corner of the cell
};
using CellLoop = std::vector<LoopPoint>;  ///< counter-clockwise around the cell

/// The loops of all cells and the choice of their corners.
class CellLoops {
 public:
  /// \param node  by overlay point: whether sides of cells end there
  CellLoops(const Parametrization& map, const GridOverlay& overlay, const std::vector<bool>& node);

  int cellCount() const { return int(loops_.size()); }
  const std::vector<CellLoop>& loops(int cell) const { return loops_[cell]; }
  WideQuanta doubleArea(int cell) const { return area_[cell]; }  ///< quanta squared
  int firstPiece(int cell) const { return firstPiece_[cell]; }   ///< of the overlay
  bool isFull(int cell) const;
  /// Whether a loop comes through one point twice, around a hole that touches the cell's border there.
  bool isPinched(int cell) const;
  int pointOf(const LoopPoint& p) const { return overlay_.halfedges[p.halfedge].origin; }

  /// The positions of the loops' corners in one plane, the outer loop first: in a common chart, or where the
  /// cell winds around a point at which the charts do not agree (a singularity in the hole), in a projection.
  void bringIntoOnePlane(int cell);

 private:
  void joinPieces();
  void walkLoops(const std::vector<bool>& node);
  CellLoop walkLoop(int start, const std::vector<bool>& node) const;
  void keepEnough(int cell);
  void separateCoincidingSides();
  bool onBoundaryOnly(const LoopPoint& p) const;
  struct Farthest {
    double distance;
    size_t index;
  };
  std::optional<Farthest> farthestOnSide(const CellLoop& loop, size_t from, size_t to) const;
  std::optional<Farthest> farthest(const CellLoop& loop) const;
  bool bringIntoOneChart(std::vector<CellLoop>& loops) const;
  bool placesAgree(const std::vector<CellLoop>& loops) const;
  void project(std::vector<CellLoop>& loops) const;

  const Parametrization& map_;
  const GridOverlay& overlay_;
  std::vector<int> cellOfPiece_, firstPiece_;
  std::vector<WideQuanta> area_;
  std::vector<std::vector<CellLoop>> loops_;
};

}  // namespace trimquad
