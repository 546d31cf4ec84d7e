#pragma once

#include <Eigen/Core>
#include <vector>

#include "trimquad/base/fixed.h"

namespace trimquad {

/// Cuts a polygon with holes into simple polygons by diagonals between its corners.
/// \param loops  positions in the plane, the outer loop counter-clockwise, the holes clockwise; under 2^44 in
/// size \returns polygons as (loop, corner) pairs; every loop edge occurs in one of them, every diagonal in
/// two. No polygon has a corner twice, and diagonals cross nothing as long as the loops do not.
struct LoopCorner {
  int loop, corner;
  friend auto operator<=>(const LoopCorner&, const LoopCorner&) = default;
};
std::vector<std::vector<LoopCorner>> simplePolygons(const std::vector<std::vector<FixedVector>>& loops);

}  // namespace trimquad
