#pragma once

#include <map>
#include <set>

#include "trimquad/quads/quad_mesh.h"

namespace trimquad {

/// A quad mesh whose cells are merged and whose inner points go into boundary ones. The mesh is what it
/// should be again after `finish`.
class CellMerge {
 public:
  using Side = std::array<QuadPointId, 2>;  ///< in the direction of the cell to its left

  explicit CellMerge(QuadMesh& quads);

  static Side reversed(const Side& side) { return {side[1], side[0]}; }
  const QuadMesh::Cell& operator[](CellId cell) const { return quads_.cells[cell.index]; }
  const QuadMesh::Point& operator[](QuadPointId point) const { return quads_.points[point.index]; }
  std::vector<Side> sidesOf(CellId cell) const;
  void setCell(const Side& side, CellId cell) { cellAt_[side] = cell; }
  std::optional<CellId> across(const Side& side) const;
  bool isGone(CellId cell) const { return mergedInto_[cell.index].has_value(); }

  /// Whether one other cell lies beyond a side of a cell, and the side is no feature edge.
  bool isMovable(CellId cell, const Side& side) const;

  /// Whether a cell with one simple loop can be merged across a side of it: the cells on both sides have only
  /// the side's ends in common, and it is no feature edge.
  bool isMergeable(CellId cell, const Side& side) const;
  /// The longest such side, in space.
  std::optional<Side> mergeableSide(CellId cell) const;
  /// Merges a cell with the one across such a side, which stays. It counts as trimmed.
  void merge(CellId cell, const Side& side);

  /// Whether the inner point may go into the boundary point that a side leads it to, once the cell `merged`
  /// is: no cell touches itself then, none has fewer than three corners, and the side is no feature edge.
  bool isCollapsible(const Side& side, const std::vector<CellId>& merged) const;
  /// Merges the side's start into its end.
  void collapse(const Side& side);

  /// Says of a cell that merges and collapses left it as it was that it is a whole quad.
  void markWhole(CellId cell);

  void finish();

 private:
  std::set<QuadPointId> pointsOf(CellId cell) const;
  std::vector<CellId> cellsAround(QuadPointId point) const;
  bool isFeature(const Side& side) const { return feature_.count(side) || feature_.count(reversed(side)); }
  void dropMergedCells();
  void dropUnusedPoints();
  void updateKinds();

  QuadMesh& quads_;
  std::vector<std::optional<CellId>> mergedInto_;  ///< by cell
  std::set<Side> feature_;
  std::map<Side, CellId> cellAt_;  ///< the cell to the left
  std::set<Side> doubled_;         ///< sides that several cells have: they stay
};

}  // namespace trimquad
