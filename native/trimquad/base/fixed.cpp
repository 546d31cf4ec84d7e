#include "trimquad/base/fixed.h"

#include "trimquad/base/error.h"

namespace trimquad {

FixedScale FixedScale::fitting(double largest) {
  int exponent = 0;
  std::frexp(std::max(largest, 1.0), &exponent);  // largest < 2^exponent
  return {std::max(0, kCoordinateBits - 1 - exponent)};
}

int compareCrossings(FixedVector a, FixedVector b, int axis1, Quanta c1, int axis2, Quanta c2) {
  // t_i = (c_i - a_i) / (b_i - a_i), both in [0, 1]
  WideQuanta n1 = c1 - a[axis1], d1 = b[axis1] - a[axis1];
  WideQuanta n2 = c2 - a[axis2], d2 = b[axis2] - a[axis2];
  TRIMQUAD_ASSERT(d1 != 0 && d2 != 0);
  if (d1 < 0) n1 = -n1, d1 = -d1;
  if (d2 < 0) n2 = -n2, d2 = -d2;
  return sign(n1 * d2 - n2 * d1);
}

bool strictlyInsideSector(FixedVector from, FixedVector to, FixedVector d) {
  const int turn = sign(cross(from, to));
  const bool leftOfFrom = sign(cross(from, d)) > 0, rightOfTo = sign(cross(d, to)) > 0;
  if (turn > 0) return leftOfFrom && rightOfTo;
  if (turn < 0)
    return leftOfFrom || rightOfTo || (sign(cross(from, d)) == 0 && dot(from, d) < 0 && rightOfTo);
  if (dot(from, to) < 0) return leftOfFrom;
  return !(sign(cross(from, d)) == 0 && dot(from, d) > 0);
}

}  // namespace trimquad
