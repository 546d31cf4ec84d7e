#include "trimquad/spline/trim_curve.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/trim_samples.h"
#include "trimquad/mesh/polyline_curve.h"

namespace trimquad {
namespace {

using namespace test;

/// A curve on a sheet, and where the map has its stations.
struct CurveOnSheet {
  Sheet sheet;
  ModelCurve curve;
  BoundaryRun run{};

  CurveOnSheet(SplineSurface surface, const std::vector<Eigen::Vector3d>& points)
      : sheet{std::move(surface), {}, 0} {
    auto chain = std::make_shared<PolylineCurve>(points);
    run.points = points;
    run.t = chain->parameters();
    curve = {chain, CornerId{0}, CornerId{1}, "Edge1"};
  }

  SheetSide side() const { return {&sheet, &run, "region 1", run.uv.front(), run.uv.back()}; }
};

TEST(TrimCurve, IsLedToACornerThatLiesOffItsEndInBothDirections) {
  const double scale = 28, length = 9.2;
  for (const double off : {0.03, 0.07, 0.2, 0.6}) {
    CurveOnSheet c(interpolated([&](double u, double v) { return Eigen::Vector3d(scale * u, scale * v, 0); },
                                -1, 1, 4, -1, 1, 4),
                   {{0, 0, 0}, {length / 6, 0, 0}, {length, 0, 0}});
    for (const auto& p : c.run.points) c.run.uv.push_back(p.head<2>() / scale);
    auto side = c.side();
    const auto sampled = sampleCurve(c.curve, {side}, 1);
    side.end += Eigen::Vector2d(-3 * off, off) / scale;
    const double closeness = 0.0256;
    const auto pieces = freeEdge(sampled, side, {closeness, closeness}, {});
    ASSERT_EQ(pieces.size(), 1u) << off;
    EXPECT_LT((pieces[0].curve.poles.back() - Eigen::Vector3d(length - 3 * off, off, 0)).norm(), 1e-9) << off;
    constexpr int kSamples = 1000;
    for (int i = 0; i <= kSamples; ++i) {
      const auto p = pieces[0].curve.point(length * i / kSamples);
      EXPECT_LT(std::abs(p[1]), off + closeness) << off;
      if (p[0] < length / 2) {
        EXPECT_LT(std::abs(p[1]), closeness) << off;
      }
    }
    EXPECT_LT(pieces[0].curve.knots.size(), 300u) << off;
  }
}

TEST(TrimCurve, IsNoIntersectionOfSheetsWhoseWedgeClosesTowardsAnEnd) {
  const double length = 9;
  for (const double leastSlope : {0.0, 0.1}) {
    const auto side = [&](double sign) {
      return CurveOnSheet(interpolated(
                              [=](double u, double v) {
                                const double slope = leastSlope + 0.2 * std::tanh(u / 0.03);
                                return Eigen::Vector3d(u, v, sign * v * slope);
                              },
                              0, length, 600, -1, 1, 4),
                          {{0, 0, 0}, {length / 2, 0, 0}, {length, 0, 0}});
    };
    CurveOnSheet a = side(1), b = side(-1);
    for (auto* c : {&a, &b})
      for (const auto& p : c->run.points) c->run.uv.push_back(p.head<2>());
    const std::vector<SheetSide> sides{a.side(), b.side()};
    const auto sampled = sampleCurve(a.curve, sides, 0.1);
    EXPECT_EQ(bool(intersectionCurve(sampled, sides, 1e-3, 0.1, kSmallestCrossing, {}, {})), leastSlope > 0);
  }
}

TEST(TrimCurve, ShowsItsGapAtItsStart) {
  const double scale = 28, length = 9;
  CurveOnSheet c(interpolated([&](double u, double v) { return Eigen::Vector3d(scale * u, scale * v, 0); },
                              -1, 1, 4, -1, 1, 4),
                 {{0, 0, 0}, {length, 0, 0}});
  for (const auto& p : c.run.points) c.run.uv.push_back(p.head<2>() / scale);
  const std::vector<SheetSide> sides(2, c.side());
  const double exact = 1e-7, most = 1e-5;
  for (const double gap : {4e-8, 4e-7, 4e-6, 4e-5})
    for (const double risesBy : {0.5, 0.1, 0.01}) {
      const SplineCurve<3> straight{
          3, {0, 0, 0, 0, 9, 9, 9, 9}, {{0, 0, 0}, {3, 0, 0}, {6, 0, 0}, {9, 0, 0}}};
      PlaneCurve onSheet{3, straight.knots, {}};
      for (const auto& pole : straight.poles) onSheet.poles.push_back(pole.head<2>() / scale);
      TrimPiece piece{straight, {onSheet, onSheet}, gap};
      // One image leaves the curve soon after its start, and comes back at its end.
      auto& off = piece.onSheet[1];
      for (const double at : {risesBy, 1 - risesBy}) off = withKnot(off, at * length, 3);
      for (std::size_t i = 3; i + 3 < off.poles.size(); ++i) off.poles[i][1] = gap / scale;
      exposeGap(piece, sides, exact, most);
      if (gap < exact || gap > most) {
        EXPECT_EQ(piece.curve.poles, straight.poles) << gap;
        continue;
      }
      const auto gapAt = [&](double s) {
        const Eigen::Vector3d p = piece.curve.point(s);
        double largest = 0;
        for (const auto& x : piece.onSheet)
          largest = std::max(largest, std::hypot((p.head<2>() - scale * x.point(s)).norm(), p[2]));
        return largest;
      };
      EXPECT_GT(gapAt(0), 1.2 * gap);
      EXPECT_LT(gapAt(0), 1.3 * gap);
      EXPECT_NEAR(piece.gap, gapAt(0), 1e-2 * gap);
      EXPECT_LT(gapAt(length), 1e-12);
      for (double s = length; s > 1e-12; s /= 2)  // readers of STEP start in the corner's foot on the curve
        ASSERT_GT(piece.curve.point(s).norm(), piece.curve.point(0).norm()) << gap << ' ' << s;
      constexpr int kSamples = 100000;
      for (int i = 1; i < kSamples; ++i)
        ASSERT_LT(gapAt(length * i / kSamples), gapAt(0)) << gap << ' ' << risesBy << ' ' << i;
    }
}

TEST(TrimCurve, LooksForFeetWhereTheCurveIsNotWhereItIsLedTo) {
  const auto wave = [](double u, double v) { return Eigen::Vector3d(u, v, 0.6 * std::sin(3 * u)); };
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i <= 20; ++i) points.push_back(wave(0.3 * i, 0));
  CurveOnSheet c(interpolated(wave, -3, 9, 120, -1, 1, 4), points);
  for (const auto& p : points) c.run.uv.push_back(p.head<2>());
  auto side = c.side();
  const auto sampled = sampleCurve(c.curve, {side}, 1);
  side.end += Eigen::Vector2d(1.4, 0);  // over most of a wave
  const auto pieces = freeEdge(sampled, side, {0.05, 0.2}, {});
  ASSERT_EQ(pieces.size(), 1u);
  const PlaneCurve& x = pieces[0].onSheet[0];
  EXPECT_LT((x.poles.back() - side.end).norm(), 1e-12);
  for (double s = x.first(); s < x.last(); s += 0.01) {
    EXPECT_GT(x.derivatives(s, 1)[1][0], 0) << s;
  }
}

TEST(TrimCurve, FollowsTheNearestFeetWhereTheMapIsFarFromThem) {
  const auto wave = [](double u, double v) { return Eigen::Vector3d(u, v, 0.6 * std::sin(3 * u)); };
  const auto surface = interpolated(wave, -3, 9, 120, -1, 1, 4);
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector2d> uv;
  constexpr int kStations = 60;
  for (int i = 0; i <= kStations; ++i) {
    const double u = 6.0 * i / kStations;
    points.push_back(wave(u, 0));
    // In the middle the map is most of a wave off.
    uv.push_back({u + 1.5 * std::pow(std::sin(M_PI * u / 6), 2), 0});
  }
  CurveOnSheet c(surface, points);
  c.run.uv = uv;
  const auto sampled = sampleCurve(c.curve, {c.side()}, 1);
  for (std::size_t i = 0; i < sampled.s.size(); ++i) {
    const auto& p = sampled.point[i];
    // Between stations the chain is off the surface by its sagitta.
    EXPECT_LT((c.sheet.jet(sampled.foot[0][i]).s - p).norm(), 0.01) << p.transpose();
    EXPECT_LT(std::abs(sampled.foot[0][i][0] - p[0]), 0.02) << p.transpose();
  }
}

}  // namespace
}  // namespace trimquad
