#include "trimquad/spline/knot_spacing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "trimquad/spline/sliding_data.h"

namespace trimquad {
namespace {

SplineLine line(int spans) {
  SplineLine result{3, false, {}};
  for (int i = 0; i <= spans; ++i) result.breaks.push_back(i);
  return result;
}

TEST(KnotSpacing, intervalsStandWhereTheDemandIs) {
  const SplineLine result = respaced(line(8), {0.5, 0.5, 0.5, 0.5, 2, 2, 1, 1});
  ASSERT_EQ(result.spans(), 8);
  EXPECT_EQ(result.breaks.front(), 0);
  EXPECT_EQ(result.breaks.back(), 8);
  const std::vector<double> expected{0, 2, 4, 4.5, 5, 5.5, 6, 7, 8};
  for (int i = 0; i <= 8; ++i) EXPECT_NEAR(result.breaks[i], expected[i], 0.05);
}

TEST(KnotSpacing, noDemandIsASingleInterval) {
  EXPECT_EQ(respaced(line(5), std::vector<double>(5, 1e-9)).breaks, (std::vector<double>{0, 5}));
}

TEST(KnotSpacing, closedLinesKeepTheirLeastSpans) {
  auto ring = line(12);
  ring.closed = true;
  EXPECT_EQ(respaced(ring, std::vector<double>(12, 0.1)).spans(), 4);
}

TEST(KnotSpacing, limitedDemandMakesSoManyPoles) {
  const SplineSpace space{line(20), line(10)};
  KnotDemand demand{std::vector<double>(20, 1), std::vector<double>(10, 1)};
  limitPoles(demand, space, 150);
  const auto sum = [&](int axis) { return std::accumulate(demand[axis].begin(), demand[axis].end(), 0.0); };
  EXPECT_NEAR((sum(0) + 3) * (sum(1) + 3), 150, 1e-6);
  EXPECT_NEAR(sum(0), 2 * sum(1), 1e-9);
}

/// Points of a plane whose parameters are wrong along it: where they may slide, a surface of the plane passes
/// through all of them.
TEST(SlidingData, errorsAlongTheSurfaceDoNotBendIt) {
  const SplineSpace space{line(4), line(4)};
  const Eigen::Vector3d normal = Eigen::Vector3d(1, 2, 3).normalized(),
                        a = normal.cross(Eigen::Vector3d::UnitX()).normalized(), b = normal.cross(a);
  std::vector<Datum> data;
  for (int i = 0; i < 24; ++i)
    for (int j = 0; j < 24; ++j) {
      const Eigen::Vector2d x((i + 0.5) / 6, (j + 0.5) / 6);
      const double off = (i + j) % 2 == 0 ? 0.05 : -0.05;
      // Off along the surface much, across it by a wave that cubic splines over these knots have.
      Datum d{x, (x[0] + off) * a + (x[1] - off) * b + x[0] * x[0] * x[1] * normal, 1.0 / 36};
      const Eigen::Vector3d along = a + 2 * x[0] * x[1] * normal, over = b + x[0] * x[0] * normal;
      const Eigen::Vector3d n = along.cross(over).normalized();
      d.point += off * (2 * x[0] * x[1] - x[0] * x[0]) * normal;  // stays in the tangent plane
      d.free = Eigen::Matrix3d::Identity() - n * n.transpose();
      data.push_back(d);
    }
  const auto largest = [&](const std::vector<Datum>& given) {
    const auto surface = space.leastSquares(given, {.withData = 1e-13, .withoutData = 1e-9}, Progress());
    double result = 0;
    for (const auto& d : data) {
      const Eigen::Vector3d n =
          Eigen::Vector3d((Eigen::Matrix3d::Identity() - d.free) * Eigen::Vector3d::Ones()).normalized();
      const Eigen::Vector3d off = surface->point(d.parameter[0], d.parameter[1]) - d.point;
      result = std::max(result, std::abs(n.dot(off)));
    }
    return result;
  };
  auto held = data;
  for (auto& d : held) d.free.setZero();
  EXPECT_GT(largest(held), 1e-3);
  EXPECT_LT(largest(data), 0.2 * largest(held));
}

}  // namespace
}  // namespace trimquad
