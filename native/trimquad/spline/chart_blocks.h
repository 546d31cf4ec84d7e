#pragma once

#include <vector>

#include "trimquad/spline/chart_cells.h"

namespace trimquad {

/// Cells grouped into charts; every cell is in one.
struct ChartPartition {
  std::vector<std::vector<PlacedCell>> charts;
  std::vector<int> chartOf;         ///< by cell
  std::vector<Transition> toChart;  ///< by cell

  /// Whether the surface goes on across a side within one chart.
  bool joined(const CellGraph& graph, int halfedge) const {
    return chartOf[graph.cellAt(halfedge)] == chartOf[graph.cellAcross(halfedge)];
  }
};

/// Charts between straight cuts: the separatrices of all singularities and of holes around which the grid
/// does not close (linesFromHoles), grown at the same speed, each until
/// it meets another cut or the boundary (a motorcycle graph); the aligned edges inside the surface; and more
/// grid lines where what they leave does not lie in the plane one to one.
ChartPartition blocks(const CellGraph& graph, const Progress& progress);

/// Joins neighbouring charts as long as the union is a chart that fills a good part of its bounding box, the
/// fullest first.
ChartPartition joined(const CellGraph& graph, const ChartPartition& charts, const Progress& progress);

/// Cuts the chosen charts along a grid line each: across the axis along which their surface bends more, where
/// it has bent half as much as it does in all. A chart without such a line stays whole.
ChartPartition bisected(const CellGraph& graph, const ChartPartition& charts, const std::vector<int>& chosen);

}  // namespace trimquad
