#pragma once

#include <vector>

#include "trimquad/base/progress.h"
#include "trimquad/mesh/surface_mesh.h"

namespace trimquad {

/// The triangulation of a closed polygon in space with the least area, no new points.
/// \param loop  at least three points, counter-clockwise seen from the side to which the triangles face
/// Triangles without area are used only where there is no other way. Time O(n^3). Source: G. Barequet and M.
/// Sharir, Filling gaps in the boundary of a polyhedron, 1995.
std::vector<std::array<int, 3>> leastAreaTriangulation(const std::vector<Eigen::Vector3d>& loop,
                                                       const Progress& progress);

/// Triangles of about the given edge length that close a loop: near its triangulation of least area, nearly
/// equilateral, no edge inside joins two points of the loop. The first points are the loop's. Throws
/// Error(Stage, "bridge") where the loop is such that they would have no area.
TriangleSoup holeCap(const std::vector<Eigen::Vector3d>& loop, double edgeLength, const Progress& progress);

}  // namespace trimquad
