#pragma once

#include <optional>
#include <vector>

#include "trimquad/mesh/surface_mesh.h"

namespace trimquad {

/// Which triangle sides are the same edge. Side 3 t + k runs from corner k to corner k + 1 of triangle t.
struct SideGluing {
  std::vector<std::optional<int>> opposite;  ///< by side; empty on the boundary
  std::vector<bool> sameDirection;  ///< by side: it and its opposite run the same way, so one must be turned
};

/// Glues sides with the same two vertices, then, along cracks, boundary sides with the same two places, where
/// exactly two sides have them. `place` is by vertex (firstEqualPoint). No triangle may have two corners at
/// one place. Throws Error(Input), naming the first, if an edge has more than two triangles.
SideGluing glueSides(const TriangleSoup& soup, const std::vector<int>& place);

/// By corner 3 t + k: the smallest corner of its fan, the corners around one vertex that glued sides connect.
/// Distinct fans are distinct vertices of a manifold, even where the soup has one vertex for both.
std::vector<int> cornerFans(const TriangleSoup& soup, const SideGluing& gluing);

/// By triangle: the smallest triangle that glued sides connect it to.
std::vector<int> components(const SideGluing& gluing);

/// Throws Error(Input), counting them and naming the first, if an edge has more than two triangles.
void requireManifoldEdges(const TriangleSoup& soup);

}  // namespace trimquad
