#include "trimquad/spline/fit_folds.h"

#include <gtest/gtest.h>

#include <cmath>

namespace trimquad {
namespace {

constexpr int kAround = 8;

/// A tube of radius 1 and length 1 over [0, 8) x [0, 2], and samples at the ends of a small triangle across
/// its seam.
struct Tube {
  SplineSpace space;
  std::vector<SplineSurface> surfaces;
  TriangleTree region = triangles();
  std::vector<SurfaceSample> samples;
  std::vector<std::array<int, 3>> cells{{0, 1, 2}};

  /// \param bulge of the surface in the seam, between the samples
  explicit Tube(double bulge) {
    for (int i = 0; i <= 4 * kAround; ++i) space.u.breaks.push_back(i / 4.0);
    space.u.closed = true;
    space.v.breaks = {0, 1, 2};
    std::vector<Datum> data;
    for (int i = 0; i < 20 * kAround; ++i)
      for (int j = 0; j < 20; ++j) {
        const Eigen::Vector2d x(i / 20.0, (j + 0.5) / 10);
        const double fromSeam = std::min(x[0], kAround - x[0]);
        data.push_back({x, at(x, 1 + (fromSeam < 0.1 ? bulge : 0)), 1});
      }
    surfaces.push_back(*space.leastSquares(data, {1e-9, 1e-9}, Progress()));
    for (const Eigen::Vector2d& x :
         {Eigen::Vector2d(7.6, 1), Eigen::Vector2d(0.4, 1), Eigen::Vector2d(7.6, 1.2)}) {
      auto& s = samples.emplace_back();
      s.chart = 0;
      s.parameter = x;
    }
  }

  static TriangleTree triangles() {
    std::vector<Eigen::Vector3d> points;
    std::vector<std::array<int, 3>> triangles;
    constexpr int n = 200;
    for (int i = 0; i < n; ++i) {
      const double u = double(kAround) * i / n;
      points.push_back(at({u, 0}, 1));
      points.push_back(at({u, 2}, 1));
      const int a = 2 * i, b = 2 * ((i + 1) % n);
      triangles.push_back({a, b, b + 1});
      triangles.push_back({a, b + 1, a + 1});
    }
    return {std::move(points), std::move(triangles)};
  }

  static Eigen::Vector3d at(const Eigen::Vector2d& x, double radius) {
    const double angle = 2 * M_PI * x[0] / kAround;
    return {radius * std::cos(angle), radius * std::sin(angle), x[1] / 2};
  }
};

TEST(FitFolds, betweenSamplesOnBothSidesOfASeamTheSurfaceIsLookedAtToo) {
  const Tube round(0), bulging(0.2);
  EXPECT_TRUE(stayNear(round.surfaces, round.samples, round.cells, round.region, 0.01));
  EXPECT_FALSE(stayNear(bulging.surfaces, bulging.samples, bulging.cells, bulging.region, 0.01));
  EXPECT_TRUE(stayNear(bulging.surfaces, bulging.samples, bulging.cells, bulging.region, 0.5));
}

TEST(FitFolds, trianglesBetweenChartsAreLeftOut) {
  Tube bulging(0.2);
  bulging.samples[1].chart = 1;
  EXPECT_TRUE(stayNear(bulging.surfaces, bulging.samples, bulging.cells, bulging.region, 0.01));
}

/// A plane over [0, 4] x [0, 2] that runs to and fro within 1 < u < 2, and samples around there.
struct Zigzag {
  SplineSpace space;
  std::vector<SplineSurface> surfaces;
  std::vector<SurfaceSample> samples;
  std::vector<std::array<int, 3>> cells{{0, 1, 2}, {1, 3, 2}};
  std::vector<FitPlace> feet;
  FitView view{[](int chart, const FitPlace& x) {
                 return x.chart == chart ? std::optional(x.parameter) : std::nullopt;
               },
               [](const FitPlace&) { return true; },
               [](const FitPlace&) { return 0.25; },
               [](const Eigen::Vector3d&, const Eigen::Vector3d&) { return false; },
               {}};

  Zigzag() {
    for (int i = 0; i <= 16; ++i) space.u.breaks.push_back(i / 4.0);
    space.v.breaks = {0, 1, 2};
    std::vector<Datum> data;
    for (int i = 0; i < 160; ++i)
      for (int j = 0; j < 10; ++j) {
        const Eigen::Vector2d x((i + 0.5) / 40, (j + 0.5) / 5);
        const double there = x[0] > 1 && x[0] < 2 ? 0.4 * std::sin(2 * M_PI * x[0]) : 0;
        data.push_back({x, {x[0] + there, x[1], 0}, 1});
      }
    surfaces.push_back(*space.leastSquares(data, {1e-9, 1e-9}, Progress()));
    for (const Eigen::Vector2d& x : {Eigen::Vector2d(0.9, 0.5), Eigen::Vector2d(2.1, 0.5),
                                     Eigen::Vector2d(2.1, 1.5), Eigen::Vector2d(2.9, 0.5)}) {
      auto& s = samples.emplace_back();
      s.normal = s.meshNormal = Eigen::Vector3d::UnitZ();
      s.parameter = x;
      feet.push_back({0, x});
    }
  }
  BetweenFeet look() const { return betweenFeet(surfaces, samples, feet, cells, view, 1, Progress()); }
};

TEST(FitFolds, aSurfaceThatRunsToAndFroBetweenFeetIsSeen) {
  const Zigzag zigzag;
  const auto found = zigzag.look();
  EXPECT_TRUE(found.away.empty());
  ASSERT_EQ(found.turnedOver.size(), 1u) << "one place a triangle";
  EXPECT_GT(found.turnedOver[0].parameter[0], 1);
  EXPECT_LT(found.turnedOver[0].parameter[0], 2);
  EXPECT_EQ(found.turnedOverCells, std::vector<int>{0});
}

TEST(FitFolds, whereTheRegionFacesThatWayTooNothingIsTurnedOver) {
  Zigzag zigzag;
  zigzag.view.facesLikewise = [](const Eigen::Vector3d&, const Eigen::Vector3d&) { return true; };
  EXPECT_TRUE(zigzag.look().turnedOver.empty());
}

TEST(FitFolds, betweenChartsEachIsLookedAtUpToItsBorder) {
  Zigzag zigzag;
  zigzag.surfaces.push_back(zigzag.surfaces[0]);
  zigzag.feet[1].chart = zigzag.feet[2].chart = 1;
  EXPECT_TRUE(zigzag.look().turnedOver.empty()) << "they do not see each other";
  zigzag.view.seenFrom = [](int, const FitPlace& x) { return std::optional(x.parameter); };
  EXPECT_EQ(zigzag.look().turnedOver.size(), 2u);
  zigzag.view.isInChart = [](const FitPlace& x) { return (x.parameter[0] < 1) == (x.chart == 0); };
  const auto found = zigzag.look();
  ASSERT_EQ(found.turnedOver.size(), 1u);
  EXPECT_EQ(found.turnedOver[0].chart, 1);
  zigzag.view.isInChart = [](const FitPlace& x) { return x.parameter[0] < 1; };
  EXPECT_TRUE(zigzag.look().turnedOver.empty());
}

TEST(FitFolds, bulgesBetweenFeetOnBothSidesOfASeamAreSeen) {
  for (const double bulge : {0.0, 0.2}) {
    Tube tube(bulge);
    for (auto& s : tube.samples) s.normal = s.meshNormal = Eigen::Vector3d::UnitX();
    std::vector<FitPlace> feet;
    for (const auto& s : tube.samples) feet.push_back({0, s.parameter});
    FitView view = Zigzag().view;
    view.isAway = [&](const FitPlace& x) {
      const auto p = tube.surfaces[0].point(x.parameter[0], x.parameter[1]);
      return tube.region.closest(p).squaredDistance > 0.05 * 0.05;
    };
    const auto found = betweenFeet(tube.surfaces, tube.samples, feet, tube.cells, view, 1, Progress());
    EXPECT_EQ(found.away.size(), bulge > 0 ? 1u : 0u);
    EXPECT_TRUE(found.turnedOver.empty());
  }
}

TEST(FitFolds, cellsAroundSamplesHaveOneOfThemAsACorner) {
  const std::vector<std::array<int, 3>> cells{{0, 1, 2}, {1, 3, 2}, {3, 4, 5}};
  EXPECT_TRUE(cellsAround(cells, {}).empty());
  EXPECT_EQ(cellsAround(cells, {3}), (std::vector<std::array<int, 3>>{{1, 3, 2}, {3, 4, 5}}));
  EXPECT_EQ(cellsAround(cells, {5}), (std::vector<std::array<int, 3>>{{3, 4, 5}}));
}

TEST(FitFolds, spotsGrowStifferWhileTheyFoldAndGiveWayWhereTheyFail) {
  const auto fine = [](const FitPlace&) { return 0.25; };
  const FitPlace fold{0, {3, 3}}, near{0, {3.2, 3}}, elsewhere{1, {3, 3}};
  FoldSpots spots({});
  spots.update({fold, near}, {}, fine);
  ASSERT_EQ(spots.spots().size(), 1u) << "the second lies in the spot of the first";
  EXPECT_EQ(spots.spots()[0].factor, 1);
  EXPECT_TRUE(spots.coverFolds());
  spots.update({near, elsewhere}, {}, fine);
  ASSERT_EQ(spots.spots().size(), 2u);
  EXPECT_EQ(spots.spots()[0].factor, 4);
  spots.update({near}, {fold}, fine);
  EXPECT_EQ(spots.spots()[0].factor, 1);
  spots.update({}, {}, fine);
  EXPECT_FALSE(spots.coverFolds());
}

TEST(FitFolds, fairnessGrowsOnTheChosenChartsUntilItsStepsAreDoneOrTheToleranceComesClose) {
  SplineLine line;
  for (int i = 0; i <= 8; ++i) line.breaks.push_back(i);
  const SplineSpace space{line, line};
  std::vector<SurfaceSample> samples;
  for (const int chart : {0, 1})
    for (int i = 0; i < 8; ++i) {
      auto& s = samples.emplace_back();
      s.chart = chart;
      s.parameter = {i + 0.5, 4.5};
      s.distance = i == 7 ? 0.95 : 0.1;
    }
  RectangleStiffness stiffness({&space, &space}, {{1, 2}});
  EXPECT_TRUE(stiffness.update(samples, 1));
  EXPECT_TRUE(stiffness.update(samples, 1));
  const auto chosen = stiffness.factors()[1];
  const auto at = [&](int i, int j) { return chosen[i + 8 * j]; };
  EXPECT_EQ(at(0, 0), 16) << "where there are no samples too";
  EXPECT_EQ(at(3, 4), 16);
  EXPECT_EQ(at(7, 4), 1);
  EXPECT_EQ(at(6, 5), 1) << "next to a rectangle where the tolerance is close";
  EXPECT_EQ(stiffness.factors()[0], std::vector<double>(64, 1.0));
  EXPECT_FALSE(stiffness.update(samples, 1));
  EXPECT_EQ(stiffness.factors()[1], chosen);
}

TEST(FitFolds, whereKnotIntervalsAreWideThereAreNoSpots) {
  FoldSpots spots({});
  spots.update({{0, {3, 3}}}, {}, [](const FitPlace&) { return 2.0; });
  EXPECT_TRUE(spots.spots().empty());
  EXPECT_FALSE(spots.coverFolds());
}

}  // namespace
}  // namespace trimquad
