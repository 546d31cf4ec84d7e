#pragma once

#include <Eigen/Core>
#include <vector>

namespace trimquad {

/// By point: the first point with bitwise the same coordinates (0 and -0 are the same). Finite points. O(n
/// log n).
std::vector<int> firstEqualPoint(const std::vector<Eigen::Vector3d>& points);

}  // namespace trimquad
