#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "trimquad/base/fixed.h"

namespace trimquad {

/// A directed segment of a boundary's image in the plane; the region lies to its left.
struct BoundarySegment {
  FixedVector from, to;
  int next;  ///< index of the segment that continues the loop; the same point up to a multiple of the period
};

/// Two segments, by index, that have a point in common which is not the joint of neighbours in a loop; none
/// where the loops are disjoint simple polygons. With a period the plane is rolled up in u. Exact; O(n log n)
/// for segments of similar length.
std::optional<std::pair<int, int>> firstContact(const std::vector<BoundarySegment>& segments,
                                                std::optional<Quanta> period);

}  // namespace trimquad
