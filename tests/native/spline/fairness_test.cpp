#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "trimquad/spline/spline_space.h"

namespace trimquad {
namespace {

SplineSpace square(int spans, double width) {
  SplineLine line;
  for (int i = 0; i <= spans; ++i) line.breaks.push_back(i * width);
  return {line, line};
}

/// The least of the normal's third coordinates.
double leastUp(const SplineSurface& s, double side) {
  double least = HUGE_VAL;
  for (double u = 0.01 * side; u < side; u += 0.02 * side)
    for (double v = 0.01 * side; v < side; v += 0.02 * side) {
      const auto jet = s.jet(u, v);
      least = std::min(least, jet.su.cross(jet.sv)[2]);
    }
  return least;
}

TEST(Fairness, countsOnNarrowRectanglesByTheirAreaAndByItsFactorInSpots) {
  const SplineSpace space = square(8, 0.125);
  Fairness fairness{2, 3};
  const double narrow = std::pow(0.125 * 0.125, 2);
  EXPECT_DOUBLE_EQ(fairness.weight(space.u, 1, space.v, 6, true), 2 * narrow);
  EXPECT_DOUBLE_EQ(fairness.weight(space.u, 1, space.v, 6, false), 3 * narrow);
  fairness.spots = {{0, {0.2, 0.8}, 0.1, 5}, {0, {0.2, 0.8}, 0.01, 7}};
  EXPECT_DOUBLE_EQ(fairness.weight(space.u, 1, space.v, 6, true), 2 * 7);
  EXPECT_DOUBLE_EQ(fairness.weight(space.u, 2, space.v, 6, true), 2 * 5) << "within reach of one only";
  EXPECT_DOUBLE_EQ(fairness.weight(space.u, 2, space.v, 6, false), 2 * 5);
  EXPECT_DOUBLE_EQ(fairness.weight(space.u, 4, space.v, 6, true), 2 * narrow);
}

TEST(Fairness, ofAChartHasItsSpotsAndItsStiffnessOnly) {
  const SplineSpace space = square(2, 1);
  Fairness fairness{2, 3};
  fairness.spots = {{1, {0.5, 0.5}, 0.1, 5}};
  fairness.stiffness = {{1, 1, 1, 1}, {1, 1, 1, 7}};
  const Fairness first = fairness.ofChart(0), second = fairness.ofChart(1);
  EXPECT_DOUBLE_EQ(first.weight(space.u, 0, space.v, 0, true), 2);
  EXPECT_DOUBLE_EQ(first.weight(space.u, 1, space.v, 1, true), 2);
  EXPECT_DOUBLE_EQ(second.weight(space.u, 0, space.v, 0, true), 10);
  EXPECT_DOUBLE_EQ(second.weight(space.u, 1, space.v, 1, true), 14);
  EXPECT_DOUBLE_EQ(second.weight(space.u, 1, space.v, 1, false), 21);
}

TEST(Fairness, inASpotUnfoldsASurfaceWhoseDataChangedPlacesAndLeavesTheRestAlone) {
  const double side = 4;
  const SplineSpace space = square(16, 0.25);
  // A plane, but in a small square the parameters run the wrong way.
  std::vector<Datum> data;
  for (int i = 0; i < 80; ++i)
    for (int j = 0; j < 80; ++j) {
      const Eigen::Vector2d x((i + 0.5) * 0.05, (j + 0.5) * 0.05);
      const bool wrong = (x - Eigen::Vector2d(2, 2)).lpNorm<Eigen::Infinity>() < 0.3;
      data.push_back({x, {wrong ? 4 - x[0] : x[0], x[1], 0}, 0.05 * 0.05});
    }
  Fairness fairness{1e-6, 1e-6};
  const auto folded = space.leastSquares(data, fairness, Progress());
  ASSERT_TRUE(folded);
  EXPECT_LT(leastUp(*folded, side), 0);
  fairness.spots = {{0, {2, 2}, 0.5, 1e5}};
  const auto smooth = space.leastSquares(data, fairness, Progress());
  ASSERT_TRUE(smooth);
  EXPECT_GT(leastUp(*smooth, side), 0);
  for (const double at : {0.3, 1.0, 3.1, 3.7})
    EXPECT_LT((smooth->point(at, at) - Eigen::Vector3d(at, at, 0)).norm(), 1e-3);
}

}  // namespace
}  // namespace trimquad
