#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

namespace trimquad {

/// Triangles of a simple polygon, in its orientation, as places in `polygon`: a quad's along the diagonal
/// from its first corner, as other programs show one that is not flat, or else ears along the shortest
/// diagonals that lie inside, seen in the polygon's mean plane. A polygon without area is cut into triangles
/// without area. nullopt if the polygon crosses itself there. Source: ear clipping, G. Meisters, Polygons
/// have ears, 1975.
std::optional<std::vector<std::array<int, 3>>> triangulatePolygon(std::span<const Eigen::Vector3d> polygon);

}  // namespace trimquad
