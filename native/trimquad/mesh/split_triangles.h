#pragma once

#include <vector>

#include "trimquad/mesh/region.h"

namespace trimquad {

/// Put the loose vertex `v` into an edge or a triangle. `origin` (by triangle, or empty) is handed on to the
/// parts. All other elements keep their numbers; new ones come last.
void splitEdge(SurfaceMesh& mesh, EdgeHandle e, VertexHandle v, std::vector<int>& origin);
void splitFace(SurfaceMesh& mesh, FaceHandle f, VertexHandle v, std::vector<int>& origin);

/// The vertex at the point with these barycentric coordinates (by corner, from halfedge_handle(f) on) of a
/// triangle: a new one, unless the point is a corner up to 1e-6. A point that is on an edge up to 1e-6 goes
/// into the edge.
VertexHandle insertPoint(SurfaceMesh& mesh, FaceHandle f, const Eigen::Vector3d& barycentric,
                         std::vector<int>& origin);

/// Splits inner edges that are not aligned but join two vertices on aligned edges or feature points, in the
/// middle (on the true surface where there is one), and then triangles that still have three such corners.
/// Afterwards every triangle has at most one aligned edge and a corner that no constraint holds, without
/// which a map that keeps to the constraints could not be locally injective. The aligned edges stay.
void splitConstrainedTriangles(Region& region);

}  // namespace trimquad
