#pragma once

#include <vector>

#include "trimquad/base/fixed.h"

namespace trimquad {

struct PlanarCorner {
  int point;           ///< corners are the same when their points are
  FixedVector at;      ///< position in the plane
  bool inner = false;  ///< other polygons meet all around it: diagonals rather end elsewhere
};

/// Cuts a polygon with holes into simple polygons by diagonals between its corners.
/// \param loops  the outer loop counter-clockwise, the holes clockwise; a loop may pass through a point
/// several times \returns polygons of points; every loop edge occurs in one of them, every diagonal in two.
/// No polygon has a point twice, and diagonals cross nothing as long as the loops do not.
std::vector<std::vector<int>> simplePolygons(const std::vector<std::vector<PlanarCorner>>& loops);

}  // namespace trimquad
