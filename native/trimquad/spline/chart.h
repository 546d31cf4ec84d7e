#pragma once

#include <optional>
#include <vector>

#include "trimquad/gridmap/grid_map.h"

namespace trimquad {

/// A region's whole grid map unrolled into one plane: a rectangle of it, or a strip that closes after
/// `period` quads in u (a tube). Coordinates are the grid map's own up to one quarter-turn rotation.
struct Chart {
  FixedScale scale;
  std::vector<FixedVector> corner;  ///< by halfedge index, as in Parametrization; modulo the period in u
  std::optional<Quanta> period;     ///< of u; a whole number of quads
};

/// Throws Error(Stage, "fit") where one chart cannot hold the region: transitions with rotations, periods in
/// both directions or with an oblique translation, or an image that covers a part of the plane twice (exact
/// test of the boundary loops, modulo the period).
Chart chart(const GridMap& map);

/// The same, empty instead of an error.
std::optional<Chart> singleChart(const GridMap& map);

/// An open chart turned by an angle so that its bounding rectangle is the smallest, to a degree. Coordinates
/// are rounded to quanta; grid lines are no longer lines of the plane.
Chart turnedToSmallestRectangle(const Chart& chart, const SurfaceMesh& mesh);

}  // namespace trimquad
