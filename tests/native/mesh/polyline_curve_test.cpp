#include "trimquad/mesh/polyline_curve.h"

#include "support/error_of.h"
#include "support/mesh_samples.h"

namespace trimquad {
namespace {

std::vector<Eigen::Vector3d> circle(int n) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i <= n; ++i) points.emplace_back(std::cos(2 * kPi * i / n), std::sin(2 * kPi * i / n), 0);
  points.back() = points.front();
  return points;
}

TEST(PolylineCurve, parameterIsArcLength) {
  const PolylineCurve curve({{0, 0, 0}, {3, 0, 0}, {3, 4, 0}});
  EXPECT_EQ(curve.last(), 7);
  EXPECT_EQ(curve.point(1), Eigen::Vector3d(1, 0, 0));
  EXPECT_EQ(curve.point(3), Eigen::Vector3d(3, 0, 0));
  EXPECT_EQ(curve.point(5), Eigen::Vector3d(3, 2, 0));
  EXPECT_EQ(curve.point(7), Eigen::Vector3d(3, 4, 0));
  EXPECT_EQ(curve.tangent(5), Eigen::Vector3d(0, 1, 0));
}

TEST(PolylineCurve, closestIsTheParameterOfAPointOfTheCurve) {
  const PolylineCurve curve(circle(64));
  std::mt19937 random(2);
  std::uniform_real_distribution<double> parameter(curve.first(), curve.last()), shift(-0.3, 0.3);
  for (int i = 0; i < 300; ++i) {
    const double t = parameter(random);
    const Eigen::Vector3d p = curve.point(t);
    const double guess = std::clamp(t + shift(random), curve.first(), curve.last());
    EXPECT_NEAR(curve.closest(p, guess), t, 1e-9);
  }
}

TEST(PolylineCurve, closestPassesTheJointOfAClosedCurve) {
  const PolylineCurve curve(circle(64));
  EXPECT_NEAR(curve.closest(curve.point(0.2), curve.last() - 0.2), 0.2, 1e-12);
  EXPECT_NEAR(curve.closest(curve.point(curve.last() - 0.2), 0.2), curve.last() - 0.2, 1e-12);
}

TEST(PolylineCurve, closestStaysNearItsGuessWhereTheCurveComesBack) {
  // A hairpin: the other leg is as close.
  const PolylineCurve curve({{0, 0, 0}, {10, 0, 0}, {10, 0.1, 0}, {0, 0.1, 0}});
  EXPECT_NEAR(curve.closest({3, 0.06, 0}, 3), 3, 1e-12);
}

TEST(PolylineCurve, needsDistinctPoints) {
  EXPECT_TRUE(errorOf([] { PolylineCurve({{0, 0, 0}}); }));
  EXPECT_TRUE(errorOf([] { PolylineCurve({{0, 0, 0}, {0, 0, 0}}); }));
}

}  // namespace
}  // namespace trimquad
