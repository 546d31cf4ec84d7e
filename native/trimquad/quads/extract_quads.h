#pragma once

#include <vector>

#include "trimquad/base/progress.h"
#include "trimquad/gridmap/grid_map.h"
#include "trimquad/quads/quad_mesh.h"

namespace trimquad {

/// The quad mesh of an integer grid map: the preimage of the grid, cut at the surface's boundary. (Paper,
/// section 6.2) \param corners  boundary vertices that must stay corners of the mesh, because the boundary
/// turns there Guarantees: every grid point inside has as many quads as the map has quarter turns around it,
/// the Euler characteristic is that of the surface, the parametric areas of the cells add up to that of the
/// map; all exactly. Throws Error(Stage) where the map is no integer grid map, and where a cell would touch
/// itself because the surface is less than a quad wide.
QuadMesh extractQuads(const GridMap& map, const std::vector<VertexHandle>& corners, const Progress& progress);

}  // namespace trimquad
