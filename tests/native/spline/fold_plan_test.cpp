#include "trimquad/spline/fold_plan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/trim_samples.h"

namespace trimquad {
namespace {

using namespace test;

/// A plane and a sheet that turns about the x axis, from one angle against the plane at x = 0 to another at
/// x = 10.
FoldPlan planBetween(double first, double last) {
  const Sheet plane{
      interpolated([](double x, double y) { return Eigen::Vector3d(x, y, 0); }, -1, 11, 12, -2, 2, 4), {}, 0};
  const Sheet turning{interpolated(
                          [&](double x, double y) {
                            const double angle = first + (last - first) * x / 10;
                            return Eigen::Vector3d(x, y * std::cos(angle), y * std::sin(angle));
                          },
                          -1, 11, 60, -2, 2, 8),
                      {},
                      0};
  SampledCurve sampled{nullptr, {}, {}, {}, {{}, {}}};
  for (int i = 0; i <= 200; ++i) {
    const double x = 10 * i / 200.0;
    sampled.t.push_back(x);
    sampled.s.push_back(x);
    sampled.point.push_back({x, 0, 0});
    for (auto& feet : sampled.foot) feet.push_back({x, 0});
  }
  return planFold(sampled, {&plane, &turning}, true, {{{true, true}, {true, true}}});
}

TEST(FoldPlan, sheetsStayTangentInTheCornersWhereTheyAre) {
  const auto plan = planBetween(0, 0);
  ASSERT_EQ(plan.tangent.size(), 2u);
  EXPECT_TRUE(plan.near.front() && plan.near.back());
  EXPECT_FALSE(plan.near[100]);
}

TEST(FoldPlan, sheetsThatCrossSteeplyInACornerHaveAnIntersectionThere) {
  for (const double steep : {0.5, std::numbers::pi / 2}) {
    const auto plan = planBetween(steep, 0);
    ASSERT_EQ(plan.tangent.size(), 1u) << steep;
    EXPECT_GT(plan.tangent[0].first, 5) << steep;
    EXPECT_FALSE(plan.near.front()) << steep;
    EXPECT_TRUE(plan.near.back()) << steep;
  }
}

}  // namespace
}  // namespace trimquad
