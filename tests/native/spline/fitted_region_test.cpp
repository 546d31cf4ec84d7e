#include "trimquad/spline/fitted_region.h"

#include <gtest/gtest.h>

#include "support/sample_regions.h"

namespace trimquad {
namespace {

constexpr double kTolerance = 0.01;

/// A place of a surface that lies like the square, at a height.
SplineSurface::Jet level(double x, double y, double z) {
  const Eigen::Vector3d none = Eigen::Vector3d::Zero();
  return {{x, y, z}, {1, 0, 0}, {0, 1, 0}, none, none, none};
}

class FittedSquare : public testing::Test {
 protected:
  const Region square =
      sample::region({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}});
  const FittedRegion fitted{square, kTolerance, kTolerance};
};

TEST_F(FittedSquare, BulgesAreFartherAwayThanIsEnough) {
  EXPECT_FALSE(fitted.farther(level(0.25, 0.5, 0.9 * kTolerance), fitted.limit()));
  const auto bulge = fitted.farther(level(0.25, 0.5, -10 * kTolerance), fitted.limit());
  ASSERT_TRUE(bulge);
  EXPECT_DOUBLE_EQ(bulge->distance, 10 * kTolerance);
  EXPECT_EQ(bulge->point, Eigen::Vector3d(0.25, 0.5, 0));
}

TEST_F(FittedSquare, WhatGoesOnBeyondTheBoundaryIsNoBulge) {
  EXPECT_FALSE(fitted.farther(level(1.3, 0.5, 0), fitted.limit()));
  // A surface may be anywhere there, if it is farther beyond the boundary than above it.
  EXPECT_FALSE(fitted.farther(level(1.3, 0.5, 10 * kTolerance), fitted.limit()));
  EXPECT_FALSE(fitted.farther(level(-0.3, 1.3, -10 * kTolerance), fitted.limit()));
}

TEST_F(FittedSquare, AboveTheBoundaryBulgesCount) {
  const auto bulge = fitted.farther(level(1 + kTolerance, 0.5, 10 * kTolerance), fitted.limit());
  ASSERT_TRUE(bulge);
  EXPECT_DOUBLE_EQ(bulge->distance, 10 * kTolerance);
}

}  // namespace
}  // namespace trimquad
