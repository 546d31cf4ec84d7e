#include "trimquad/spline/intersection_curve.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/trim_samples.h"

namespace trimquad {
namespace {

using namespace test;

/// Two sheets over [-1, 11] x [-2, 2] that make a ridge along y = 0 but where it is nothing, around x = 5;
/// `apart` from each other.
struct Ridge {
  explicit Ridge(double apart)
      : a{interpolated([](double x, double y) { return height(x, y, 1); }, -1, 11, 60, -2, 2, 8), {}, 0},
        b{interpolated(
              [=](double x, double y) {
                return Eigen::Vector3d(height(x, y, -1) + Eigen::Vector3d(0, 0, apart));
              },
              -1, 11, 60, -2, 2, 8),
          {},
          0} {}
  static Eigen::Vector3d height(double x, double y, double sign) {
    const double slope = 0.05 * std::min(1.0, std::pow((x - 5) / 2, 2));
    return {x, y, 0.3 * std::sin(x) + sign * slope * y};
  }
  IntersectionCurve curve() const {
    SpaceCurve reference;
    reference.degree = 5;
    constexpr int kPoles = 20;
    for (int i = 0; i <= kPoles + 5; ++i)
      reference.knots.push_back(std::clamp((i - 5) / double(kPoles - 5), 0.0, 1.0) * 10);
    for (int i = 0; i < kPoles; ++i) {
      double x = 0;  // Greville abscissa
      for (int k = 1; k <= 5; ++k) x += reference.knots[i + k] / 5;
      reference.poles.push_back({x, 1e-4 * std::cos(x), 0.3 * std::sin(x)});
    }
    std::vector<IntersectionCurve::Guess> guesses;
    for (int i = 0; i <= 100; ++i) {
      const double s = 0.1 * i;
      guesses.push_back({s, {s, 0, s, 0}});
    }
    return {a, b, reference, guesses, 1, 0.005, {{4.5, 5.5, 1}}};
  }
  Sheet a, b;
};

TEST(IntersectionCurve, IsExactAwayFromTangentStretchesAndContinuousOverThem) {
  const double apart = 1e-5;
  const Ridge ridge(apart);
  const auto curve = ridge.curve();
  std::optional<IntersectionCurve::Parameters> before;
  for (double s = 0.05; s < 10; s += 0.01) {
    const auto z = curve.parameters(s);
    ASSERT_TRUE(z) << s;
    const double gap = (ridge.a.jet(z->head<2>()).s - ridge.b.jet(z->tail<2>()).s).norm();
    EXPECT_NEAR(gap, curve.apart(s), 1e-12);
    EXPECT_LE(gap, std::abs(s - 5) < 1.5 ? 1.5 * apart : 1e-11) << s;
    if (before) {
      EXPECT_LE((*z - *before).norm(), 0.03) << s;
    }
    before = z;
  }
  EXPECT_FALSE(IntersectionCurve(ridge.a, ridge.b, curve.reference(),
                                 {{0, {0, 0, 0, 0}}, {10, {10, 0, 10, 0}}}, 1, 0.005)
                   .parameters(5))
      << "where nothing says that the sheets may be tangent";
}

TEST(IntersectionCurve, DerivativesAreThoseOfItsPoints) {
  const Ridge ridge(1e-3);
  const auto curve = ridge.curve();
  for (const double s : {2.2, 3.8, 4.2, 4.9, 5.2, 5.7, 6.3, 8.1}) {
    const double h = 1e-4;
    const auto low = curve.jet(s - h), at = curve.jet(s), high = curve.jet(s + h);
    EXPECT_LE(((high.value - low.value) / (2 * h) - at.first).norm(), 1e-5) << s;
    EXPECT_LE(((high.first - low.first) / (2 * h) - at.second).norm(), 1e-3) << s;
  }
}

}  // namespace
}  // namespace trimquad
