#include "trimquad/mesh/equal_points.h"

#include <algorithm>
#include <numeric>

namespace trimquad {

std::vector<int> firstEqualPoint(const std::vector<Eigen::Vector3d>& points) {
  std::vector<int> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    const auto &p = points[a], &q = points[b];
    for (int axis = 0; axis < 3; ++axis)
      if (p[axis] != q[axis]) return p[axis] < q[axis];
    return a < b;
  });
  std::vector<int> first(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && points[order[i]] == points[order[i - 1]];
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  return first;
}

}  // namespace trimquad
