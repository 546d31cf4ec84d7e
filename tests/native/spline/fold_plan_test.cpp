#include "trimquad/spline/fold_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "support/trim_samples.h"

namespace trimquad {
namespace {

using namespace test;

/// A plane and a sheet that turns about the x axis, from one angle against the plane at x = 0 to another at
/// x = 10.
struct TurningSheet {
  TurningSheet(double first, double last)
      : plane{interpolated([](double x, double y) { return Eigen::Vector3d(x, y, 0); }, -1, 11, 12, -2, 2, 4),
              {},
              0},
        turning{interpolated(
                    [&](double x, double y) {
                      const double angle = first + (last - first) * x / 10;
                      return Eigen::Vector3d(x, y * std::cos(angle), y * std::sin(angle));
                    },
                    -1, 11, 60, -2, 2, 8),
                {},
                0} {
    for (int i = 0; i <= 200; ++i) {
      const double x = 10 * i / 200.0;
      sampled.t.push_back(x);
      sampled.s.push_back(x);
      sampled.point.push_back({x, 0, 0});
      for (auto& feet : sampled.foot) feet.push_back({x, 0});
    }
  }
  FoldPlan plan(const SampledCurve& samples) const {
    return planFold(samples, {&plane, &turning}, true, {{{true, true}, {true, true}}});
  }

  Sheet plane, turning;
  ModelCurve curve{std::make_shared<FunctionCurve>(0, 10, [](double x) { return Eigen::Vector3d(x, 0, 0); }),
                   CornerId{0}, CornerId{1}, "axis"};
  SampledCurve sampled{&curve, {}, {}, {}, {{}, {}}};
};

FoldPlan planBetween(double first, double last) {
  const TurningSheet sheet(first, last);
  return sheet.plan(sheet.sampled);
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

TEST(FoldPlan, samplesAreDenserInTangentStretchesOnly) {
  const TurningSheet sheet(0.5, 0);
  const auto before = sheet.plan(sheet.sampled);
  constexpr double step = 1.0 / 128;
  const auto denser = denserWhereTangent(sheet.sampled, before, sheet.plane, step);
  const auto after = sheet.plan(denser);
  ASSERT_EQ(after.tangent.size(), 1u);
  EXPECT_NEAR(after.tangent[0].first, before.tangent[0].first, 1e-9);
  EXPECT_NEAR(after.tangent[0].last, before.tangent[0].last, 1e-9);
  EXPECT_TRUE(
      std::includes(denser.s.begin(), denser.s.end(), sheet.sampled.s.begin(), sheet.sampled.s.end()));
  const auto inStretch = std::count(before.near.begin(), before.near.end(), 1);
  EXPECT_EQ(denser.s.size(), sheet.sampled.s.size() + 6 * (inStretch - 1));  // each 0.05 in seven
  for (std::size_t i = 0; i + 1 < denser.s.size(); ++i) {
    if (after.near[i] && after.near[i + 1]) {
      EXPECT_LE(denser.s[i + 1] - denser.s[i], step) << denser.s[i];
    }
    EXPECT_NEAR(denser.point[i][0], denser.s[i], 1e-12);
    for (const int side : {0, 1}) EXPECT_NEAR(denser.foot[side][i][0], denser.s[i], 1e-12);
  }
}

}  // namespace
}  // namespace trimquad
