#include "trimquad/spline/knot_lattice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

namespace trimquad {
namespace {

using Triangle = std::array<Eigen::Vector2d, 3>;

/// Both triangles of a rectangle from the origin.
std::array<Triangle, 2> halves(double width, double height) {
  const Eigen::Vector2d a(0, 0), b(width, 0), c(width, height), d(0, height);
  return {Triangle{a, b, c}, Triangle{a, c, d}};
}

/// Where the columns of a lattice over that rectangle are, by index.
std::map<int, double> columns(const KnotLattice& lattice, double width, double height) {
  std::map<int, double> result;
  for (const auto& triangle : halves(width, height))
    for (const auto& point : lattice.in(triangle)) {
      double u = 0;
      for (int k = 0; k < 3; ++k) u += point.barycentric[k] * triangle[k][0];
      result[point.index[0]] = u;
    }
  return result;
}

TEST(KnotLattice, dividesKnotRectanglesEvenlyAndTrianglesShareItOut) {
  const SplineSpace space{{3, false, {0, 1, 2, 4}}, {3, false, {0, 0.7, 2}}};
  std::map<std::array<int, 2>, double> area;  // by index; a point on the diagonal may be in both
  for (const auto& triangle : halves(4, 2))
    for (const auto& point : KnotLattice(space, 3).in(triangle)) area[point.index] = point.area;
  EXPECT_EQ(area.size(), 9u * 6u);
  double sum = 0;
  for (const auto& [index, part] : area) sum += part;
  EXPECT_NEAR(sum, 8, 1e-12);
}

TEST(KnotLattice, wideRectanglesAreDividedMoreCloselyBesideMuchNarrowerOnes) {
  // Otherwise the last point of the wide one would be an eighth away from 1, and nothing in between.
  const double narrow = 1.0 / 256;
  const SplineSpace space{{3, false, {0, 1, 1 + narrow, 1 + 2 * narrow, 3}}, {3, false, {0, 1}}};
  const auto at = columns(KnotLattice(space, 4), 3, 1);
  double before = 0, last = 0;
  for (const auto& [index, u] : at) {
    const double step = u - last;
    if (index > 0) {
      EXPECT_LE(std::max(step / before, before / step), 4) << u;
    }
    before = step;
    last = u;
  }
  const auto beyond = std::find_if(at.begin(), at.end(), [](const auto& x) { return x.second > 1; });
  EXPECT_LT(1 - std::prev(beyond)->second, narrow);
  EXPECT_LT(at.size(), 60u);
}

TEST(KnotLattice, closedLinesAreGradedAcrossTheirEnd) {
  const double narrow = 1.0 / 256;
  const SplineSpace space{{3, true, {0, narrow, 1, 2}}, {3, false, {0, 1}}};
  const auto at = columns(KnotLattice(space, 4), 2, 1);
  EXPECT_LT(2 - at.rbegin()->second, narrow);
}

}  // namespace
}  // namespace trimquad
