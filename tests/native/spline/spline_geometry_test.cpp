#include "trimquad/spline/spline_geometry.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <random>

namespace trimquad {
namespace {

std::vector<double> clampedKnots(int degree, std::vector<double> breaks) {
  std::vector<double> knots(degree, breaks.front());
  knots.insert(knots.end(), breaks.begin(), breaks.end());
  knots.insert(knots.end(), degree, breaks.back());
  return knots;
}

template <int Dim>
SplineCurve<Dim> randomCurve(int degree, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  SplineCurve<Dim> curve{degree, clampedKnots(degree, {-1, 0, 0.5, 2, 2.25, 4}), {}};
  curve.poles.resize(curve.knots.size() - degree - 1);
  for (auto& p : curve.poles)
    for (int k = 0; k < Dim; ++k) p[k] = uniform(random);
  return curve;
}

SplineSurface randomSurface(int degreeU, int degreeV, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-0.2, 0.2);
  SplineSurface s;
  s.degreeU = degreeU;
  s.degreeV = degreeV;
  s.knotsU = clampedKnots(degreeU, {0, 1, 2, 2.5, 4});
  s.knotsV = clampedKnots(degreeV, {-1, 0, 1, 3});
  s.countU = int(s.knotsU.size()) - degreeU - 1;
  s.countV = int(s.knotsV.size()) - degreeV - 1;
  for (int j = 0; j < s.countV; ++j)
    for (int i = 0; i < s.countU; ++i)
      s.poles.emplace_back(i + uniform(random), j + uniform(random), 2 * uniform(random));
  return s;
}

TEST(SplineGeometry, basisIsAPartitionOfUnityAndItsDerivativesVanishInSum) {
  for (int degree = 1; degree <= 9; ++degree) {
    const auto knots = clampedKnots(degree, {0, 1, 1.5, 4});
    for (double t : {0.0, 0.3, 1.0, 1.49, 3.9, 4.0, -0.5, 4.5}) {
      BasisFunctions b;
      basisFunctions(knots, degree, t, degree + 1, b);
      for (int k = 0; k <= degree + 1; ++k) {
        double sum = 0, size = 1;
        for (int j = 0; j <= degree; ++j) sum += b.value[k][j], size += std::abs(b.value[k][j]);
        EXPECT_NEAR(sum, k == 0, 1e-13 * size) << degree << " " << t << " " << k;
      }
    }
  }
}

TEST(SplineGeometry, basisHasTheSameDerivativesWhateverTheirHighestOrder) {
  for (int degree = 2; degree <= 9; ++degree) {
    auto knots = clampedKnots(degree, {0, 1, 1.5, 4, 7});
    knots.insert(std::find(knots.begin(), knots.end(), 1.5), degree - 1, 1.5);  // a corner
    for (double t : {0.0, 0.3, 1.0, 1.49, 1.5, 3.9, 4.0, 7.0, -0.5, 7.5}) {
      BasisFunctions all;
      basisFunctions(knots, degree, t, 3, all);
      for (int order = 0; order <= 2; ++order) {
        BasisFunctions some;
        basisFunctions(knots, degree, t, order, some);
        EXPECT_EQ(some.first, all.first);
        for (int k = 0; k <= order; ++k) {
          double size = 1;
          for (int j = 0; j <= degree; ++j) size = std::max(size, std::abs(all.value[k][j]));
          for (int j = 0; j <= degree; ++j)
            EXPECT_NEAR(some.value[k][j], all.value[k][j], 1e-13 * size) << degree << " " << t << " " << k;
        }
      }
    }
  }
}

TEST(SplineGeometry, curveDerivativesAgreeWithDifferences) {
  for (int degree : {2, 3, 5, 9}) {
    const auto curve = randomCurve<3>(degree, degree);
    for (double t : {-0.7, 0.2, 1.1, 2.1, 3.7}) {
      const double h = 1e-5;
      for (int k = 0; k < degree; ++k) {
        const Eigen::Vector3d difference =
            (curve.derivatives(t + h, k)[k] - curve.derivatives(t - h, k)[k]) / (2 * h);
        const Eigen::Vector3d exact = curve.derivatives(t, k + 1)[k + 1];
        EXPECT_LT((difference - exact).norm(), 1e-4 * (1 + exact.norm()) * std::pow(10, 0.3 * k))
            << degree << k;
      }
    }
  }
}

TEST(SplineGeometry, knotInsertionAndRestrictionKeepTheCurve) {
  for (int degree : {1, 2, 3, 5}) {
    const auto curve = randomCurve<2>(degree, 10 + degree);
    const auto finer = withKnot(withKnot(curve, 0.5), 1.75, degree);
    const auto piece = restricted(curve, 0.25, 2.25);
    EXPECT_EQ(piece.knots.size(), piece.poles.size() + degree + 1);
    EXPECT_EQ(piece.first(), 0.25);
    EXPECT_EQ(piece.last(), 2.25);
    EXPECT_EQ(finer.knots.size(), finer.poles.size() + degree + 1);
    for (double t = 0.25; t <= 2.25; t += 0.05) {
      EXPECT_LT((finer.point(t) - curve.point(t)).norm(), 1e-13);
      EXPECT_LT((piece.point(t) - curve.point(t)).norm(), 1e-13);
    }
    const auto whole = restricted(curve, curve.first(), curve.last());
    EXPECT_EQ(whole.knots, curve.knots);
    EXPECT_EQ(whole.poles, curve.poles);
  }
}

TEST(SplineGeometry, partsOfASurfaceAreItself) {
  const auto s = randomSurface(3, 2, 6);  // [0, 4] x [-1, 3]
  const auto part = restricted(s, {Eigen::Vector2d(0.75, -1), Eigen::Vector2d(3.25, 1.5)});
  EXPECT_EQ(part.firstU(), 0.75);
  EXPECT_EQ(part.lastU(), 3.25);
  EXPECT_EQ(part.firstV(), -1);
  EXPECT_EQ(part.lastV(), 1.5);
  EXPECT_EQ(part.poles.size(), std::size_t(part.countU) * part.countV);
  for (double u = 0.75; u <= 3.25; u += 0.25)
    for (double v = -1; v <= 1.5; v += 0.25)
      EXPECT_LT((part.point(u, v) - s.point(u, v)).norm(), 1e-13) << u << " " << v;
  const auto whole = restricted(s, {Eigen::Vector2d(0, -1), Eigen::Vector2d(4, 3)});
  EXPECT_EQ(whole.poles, s.poles);
  EXPECT_EQ(whole.knotsU, s.knotsU);
}

TEST(SplineGeometry, polarFormsAtTheKnotsOfAFinerSplineAreItsPoles) {
  for (int degree : {1, 2, 3, 5}) {
    const auto curve = randomCurve<2>(degree, 20 + degree);
    const auto finer = withKnot(withKnot(withKnot(curve, 0.5), 0.7), 1.75, degree);
    std::vector<double> weight(degree + 1);
    for (int i = 0; i < int(finer.poles.size()); ++i) {
      const auto arguments = std::span(finer.knots).subspan(i + 1, degree);
      const double middle = (finer.knots[i] + finer.knots[i + degree + 1]) / 2;
      const int first = polarForm(curve.knots, degree, middle, arguments, weight);
      Eigen::Vector2d pole = Eigen::Vector2d::Zero();
      for (int j = 0; j <= degree; ++j) pole += weight[j] * curve.poles[first + j];
      EXPECT_LT((pole - finer.poles[i]).norm(), 1e-12) << degree << " " << i;
    }
  }
}

TEST(SplineGeometry, jetAgreesWithGeneralDerivativesAndIsoCurvesWithPoints) {
  const auto s = randomSurface(3, 2, 5);
  const auto finer = withKnotV(withKnotU(s, 2.5, 2), 0.3);
  for (double u : {0.0, 0.7, 2.0, 3.3, 4.0})
    for (double v : {-1.0, 0.1, 2.9, 3.0}) {
      const auto jet = s.jet(u, v);
      const auto all = s.derivatives(u, v, 2);
      EXPECT_LT((jet.s - all[0]).norm() + (jet.su - all[1]).norm() + (jet.suu - all[2]).norm(), 1e-12);
      EXPECT_LT((jet.sv - all[3]).norm() + (jet.suv - all[4]).norm() + (jet.svv - all[6]).norm(), 1e-12);
      EXPECT_LT((s.curveAtU(u).point(v) - s.point(u, v)).norm(), 1e-13);
      EXPECT_LT((s.curveAtV(v).point(u) - s.point(u, v)).norm(), 1e-13);
      EXPECT_LT((finer.point(u, v) - s.point(u, v)).norm(), 1e-13);
    }
}

TEST(SplineGeometry, footPointIsOrthogonalInsideAndOptimalOnTheBorder) {
  const auto s = randomSurface(3, 3, 7);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> inU(0.1, 3.9), inV(-0.9, 2.9), off(-0.3, 0.3);
  for (int n = 0; n < 300; ++n) {
    const double u = inU(random), v = inV(random);
    const auto jet = s.jet(u, v);
    const Eigen::Vector3d p = jet.s + off(random) * jet.su.cross(jet.sv).normalized();
    const auto x = s.footPoint(p, {u + 0.3 * off(random), v + 0.3 * off(random)});
    const auto there = s.jet(x[0], x[1]);
    EXPECT_LT(std::abs((there.s - p).dot(there.su)) + std::abs((there.s - p).dot(there.sv)), 1e-9);
  }
  const Eigen::Vector3d beyond = s.point(4, 1) + Eigen::Vector3d(2, 0, 0);
  const auto x = s.footPoint(beyond, {3, 0.5});
  EXPECT_EQ(x[0], 4);
  for (double v = -1; v <= 3; v += 0.01)
    EXPECT_GE((s.point(4, v) - beyond).norm(), (s.point(4, x[1]) - beyond).norm() - 1e-9);
}

TEST(SplineGeometry, footPointOnASegmentIsTheClosestPointOfIt) {
  const auto s = randomSurface(3, 3, 7);
  const Eigen::AlignedBox2d segment(Eigen::Vector2d(1, 0.5), Eigen::Vector2d(2, 0.5));
  for (const double u : {0.6, 1.2, 1.7, 2.4}) {
    const Eigen::Vector3d p = s.point(u, 0.7);
    const auto x = s.footPoint(p, {std::clamp(u, 1.0, 2.0), 0.5}, segment, 1e-15);
    EXPECT_TRUE(segment.contains(x));
    for (double t = 1; t <= 2; t += 0.01)
      EXPECT_GE((s.point(t, 0.5) - p).norm(), (s.point(x[0], x[1]) - p).norm() - 1e-9);
  }
}

TEST(SplineGeometry, footPointWrapsAroundAClosedSurface) {
  // A cylinder-like closed surface: uniform quadratic poles on a circle, made clamped by knot insertion.
  const int n = 8;
  SpaceCurve ring{2, {}, {}};
  for (int i = 0; i < n + 5; ++i) ring.knots.push_back(i - 2);
  for (int i = 0; i < n + 2; ++i)
    ring.poles.emplace_back(std::cos(2 * M_PI * i / n), std::sin(2 * M_PI * i / n), 0);
  SplineSurface s;
  const auto a = ring.derivatives(0, 1), b = ring.derivatives(n, 1);
  ASSERT_LT((a[0] - b[0]).norm() + (a[1] - b[1]).norm(), 1e-12);
  s.degreeU = 2;
  s.degreeV = 1;
  s.knotsU = clampedKnots(2, {0, 1, 2, 3, 4, 5, 6, 7, 8});
  s.knotsV = {0, 0, 1, 1};
  s.countU = n + 2;
  s.countV = 2;
  s.closedU = true;
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < n + 2; ++i) {
      Eigen::Vector3d p = ring.poles[i];
      if (i == 0) p = a[0];
      if (i == n + 1) p = a[0];
      p.z() = j;
      s.poles.push_back(p);
    }
  const Eigen::Vector3d p = 1.2 * s.point(0.2, 0.5) - Eigen::Vector3d(0, 0, 0.1);
  const auto fromBelow = s.footPoint(p, {0.4, 0.5}), fromAbove = s.footPoint(p, {7.8, 0.5});
  EXPECT_LT((fromBelow - fromAbove).norm(), 1e-6);
  EXPECT_EQ(s.wrappedU(8), 0);
  EXPECT_NEAR(s.wrappedU(-0.25), 7.75, 1e-15);
}

}  // namespace
}  // namespace trimquad
