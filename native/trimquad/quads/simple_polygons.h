#pragma once

#include <vector>

#include "trimquad/quads/planar_loop.h"

namespace trimquad {

struct SimplePolygons {
  std::vector<std::vector<int>> polygons;  ///< of points
  int innerEnds = 0;                       ///< how many ends of the diagonals are inner corners
};

/// Cuts a polygon with holes into simple polygons by diagonals between its corners, which rather end at
/// corners that are not inner ones.
/// \param loops  the outer loop counter-clockwise, the holes clockwise; a loop may pass through a point
/// several times \returns polygons such that every loop edge occurs in one of them, every diagonal in two.
/// No polygon has a point twice, and diagonals cross nothing as long as the loops do not.
SimplePolygons simplePolygons(const std::vector<PlanarLoop>& loops);

}  // namespace trimquad
