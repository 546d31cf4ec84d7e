#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "trimquad/spline/cell_graph.h"

namespace trimquad {

/// A cell of a chart to be, and the way from its own plane into the chart's.
struct PlacedCell {
  int cell;
  Transition toChart;
};

/// Two cells that cannot be in one chart together: they cover the same part of the plane, or touch in the
/// plane (on closed sets) without being glued there, or are glued another way than the plane has it, or
/// across a feature line. None where the cells lie in the plane one to one. Exact.
std::optional<std::pair<int, int>> conflict(const CellGraph& graph, const std::vector<PlacedCell>& cells);

}  // namespace trimquad
