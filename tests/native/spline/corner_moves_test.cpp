#include "trimquad/spline/corner_moves.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "support/trim_samples.h"

namespace trimquad {
namespace {

using namespace test;

constexpr double kOff = 1e-3;

/// A plane through the origin, but for a deviation that `phase` shifts.
Sheet nearPlane(const Eigen::Vector3d& normal, double phase) {
  const Eigen::Vector3d n = normal.normalized(), a = n.unitOrthogonal(), b = n.cross(a);
  const auto at = [&](double u, double v) -> Eigen::Vector3d {
    return u * a + v * b + kOff * std::sin(2 * u + phase) * std::cos(3 * v - phase) * n;
  };
  return {interpolated(at, -2, 2, 16, -2, 2, 16), {}, 0};
}

struct Around {
  std::vector<Sheet> sheets;
  SheetCorner corner{Eigen::Vector3d::Zero(), {}};

  explicit Around(const std::vector<Eigen::Vector3d>& normals) {
    for (int k = 0; k < int(normals.size()); ++k) {
      sheets.push_back(nearPlane(normals[k], 0.5 + k));
      corner.uses.push_back({k, {0.01, -0.01}, false, normals[k].normalized()});
    }
  }
  std::vector<int> meet(const std::vector<char>& mayMove) {
    TrimMemory memory;
    const Progress progress;
    const auto any = [](int, const std::map<int, SplineSurface>&, bool) { return true; };
    const Layout unknown;
    std::vector<SheetBody> bodies;
    for (int k = 0; k < int(sheets.size()); ++k) bodies.push_back({k, 1, mayMove[k] ? nullptr : &unknown});
    return meetInCorners(sheets, {corner}, 1e-9, SheetMover(bodies, memory, any, progress));
  }
  SplineSurface::Jet jetAt(int k, const Eigen::Vector3d& p) const {
    return sheets[k].jet(sheets[k].footPoint(p, {0, 0}));
  }
};

TEST(CornerMoves, LeadFourSheetsThroughTheirCornerWithTheirTangentPlanes) {
  const std::vector<Eigen::Vector3d> normals = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  Around around(normals);
  const auto before = around.sheets;
  EXPECT_EQ(around.meet({1, 1, 1, 1}), (std::vector<int>{0, 1, 2, 3}));
  for (int k = 0; k < 4; ++k) {
    const auto jet = around.jetAt(k, {0, 0, 0});
    EXPECT_LT(jet.s.norm(), 1e-9) << k;
    EXPECT_LT(jet.su.cross(jet.sv).normalized().cross(normals[k].normalized()).norm(), 1e-4) << k;
    for (double u = -2; u <= 2; u += 0.125)
      for (double v = -2; v <= 2; v += 0.125) {
        const double moved = (around.sheets[k].jet({u, v}).s - before[k].jet({u, v}).s).norm();
        EXPECT_LT(moved, 1.5 * kOff) << k;
      }
  }
}

TEST(CornerMoves, LeadThreeSheetsWithTangentEdgesThroughTheirCorner) {
  // All normals lie in one plane: the edges are tangent to each other.
  Around around({{1, 0, 0}, {0, 1, 0}, {1, 1, 0}});
  EXPECT_EQ(around.meet({1, 1, 1}).size(), 3u);
  for (int k = 0; k < 3; ++k) EXPECT_LT(around.jetAt(k, {0, 0, 0}).s.norm(), 1e-9) << k;
}

TEST(CornerMoves, LeadTheOthersToWhereSheetsAreThatMayNotMove) {
  Around around({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}});
  const Eigen::Vector3d still = around.jetAt(1, {0, 0, 0}).s;
  EXPECT_GT(still.norm(), kOff / 20);
  EXPECT_EQ(around.meet({1, 0, 1, 1}), (std::vector<int>{0, 2, 3}));
  for (int k = 0; k < 4; ++k) EXPECT_LT((around.jetAt(k, still).s - still).norm(), 1e-9) << k;
}

TEST(CornerMoves, LeaveThreeSheetsAloneThatHaveACommonPoint) {
  Around around({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  EXPECT_TRUE(around.meet({1, 1, 1}).empty());
}

TEST(CornerMoves, LeaveSheetsAloneThatMayNotBecomeWhatTheyWould) {
  Around around({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}});
  int asked = 0;
  TrimMemory memory;
  const Progress progress;
  const auto none = [&](int, const std::map<int, SplineSurface>&, bool) {
    ++asked;
    return false;
  };
  const std::vector<SheetBody> bodies = {{0}, {1}, {2}, {3}};
  const auto moved =
      meetInCorners(around.sheets, {around.corner}, 1e-9, SheetMover(bodies, memory, none, progress));
  EXPECT_TRUE(moved.empty());
  EXPECT_EQ(asked, 8);  // with the tangent plane and without it
}

}  // namespace
}  // namespace trimquad
