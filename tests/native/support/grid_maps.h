#pragma once

#include "support/sample_regions.h"
#include "trimquad/gridmap/grid_map.h"
#include "trimquad/mesh/mesh_model.h"

namespace trimquad::sample {

/// The surface of unit boxes (see `boxes`) with n x n triangulated squares a side, and its grid map with
/// `quads` quads along the side of a box: every triangle in a chart of its own side.
GridMap boxesMap(const std::vector<std::array<int, 3>>& places, int n, int quads);

/// The same map on a surface of another shape.
void bend(GridMap& map, const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& place);

/// The map of an input mesh on a region that consists of its first triangles, or of all.
GridMap mapOn(const Region& region, const GridMap& map);

TriangleSoup soupOf(const SurfaceMesh& mesh);

}  // namespace trimquad::sample
