#pragma once

#include <vector>

#include "trimquad/spline/cell_graph.h"

namespace trimquad {

/// Where the grid does not close around a hole (on the way around it, it turns by quarters or is shifted by
/// whole quads), the hole is like a wide singularity: a chart that went around most of it would come close to
/// itself in the plane where the surface is far apart. Gives for each such hole grid lines that leave it, one
/// for every quarter turn around it (fewer where it is so small that none leaves it there), as halfedges of
/// the overlay that start on the boundary. Exact.
std::vector<int> linesFromHoles(const CellGraph& graph);

}  // namespace trimquad
