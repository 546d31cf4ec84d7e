#include "trimquad/spline/fit_surface.h"

#include <gtest/gtest.h>

#include <optional>
#include <random>

#include "support/analytic_region.h"
#include "support/rounds.h"
#include "trimquad/base/error.h"
#include "trimquad/spline/fitted_region.h"

namespace trimquad {
namespace {

/// z = sin x cos y on [-3, 3]^2, 28 x 28 quads, 100 x 100 points (60 x 60 under sanitizers).
AnalyticRegion centredWavySheet(double half = 14) {
  AnalyticRegion sheet = wavySheet(-half, half, 14.0 / 3);
  sheet.columns = sheet.rows = sample::fineness(99);
  return sheet;
}

struct Figures {
  double max = 0, rms = 0;
};

/// Deviation of points of the exact surface, measured afresh by foot points from a dense grid of seeds.
Figures deviation(const FittedSurface& fitted, const AnalyticRegion& a, int perSide) {
  Figures figures;
  double sum = 0;
  int count = 0;
  const auto& s = fitted.surface;
  for (int i = 0; i < perSide; ++i)
    for (int j = 0; j < perSide; ++j) {
      const double u = a.firstU + (a.lastU - a.firstU) * (i + 0.37) / perSide,
                   v = a.firstV + (a.lastV - a.firstV) * (j + 0.41) / perSide;
      if (!a.keeps(u, v)) continue;
      const Eigen::Vector3d p = a.point(u, v);
      const auto foot = s.footPoint(p, a.turn ? Eigen::Vector2d(-v, u) : Eigen::Vector2d(u, v));
      const double d = (s.point(foot[0], foot[1]) - p).norm();
      figures.max = std::max(figures.max, d);
      sum += d * d;
      ++count;
    }
  figures.rms = std::sqrt(sum / count);
  return figures;
}

/// Fits and measures again.
FittedSurface fit(AnalyticRegion& a, double tolerance, int degree = 3) {
  a.build();
  const auto result = fitSurface(a.region, a.map, {.tolerance = tolerance, .degree = degree}, Progress());
  EXPECT_LE(result.maxDeviation, tolerance);
  if (a.surface) {
    EXPECT_LE(deviation(result, a, 150).max, 1.2 * tolerance);
  }
  return result;
}

TEST(FitSurface, wavySheetMeetsTheToleranceWithFewPoles) {
  auto sheet = centredWavySheet();
  EXPECT_LE(fit(sheet, 3e-4).surface.poles.size(), 180u);
  if (!sample::kSanitized) {
    EXPECT_LE(fit(sheet, 2e-5).surface.poles.size(), 700u);
  }
  for (int degree : {2, 4, 5})
    if (!sample::kSanitized || degree == 5) fit(sheet, sample::kSanitized ? 1e-3 : 1e-4, degree);
}

/// The top of a sphere down to 75 degrees, over a disk of the plane by the azimuthal equidistant map.
AnalyticRegion dome() {
  AnalyticRegion a;
  a.columns = a.rows = 100;
  a.firstU = a.firstV = -13;
  a.lastU = a.lastV = 13;
  const double perQuad = 5 * (75 * M_PI / 180) / 12.8;
  a.point = [=](double u, double v) {
    const double arc = perQuad * std::hypot(u, v) / 5, azimuth = std::atan2(v, u);
    return Eigen::Vector3d(5 * std::sin(arc) * std::cos(azimuth), 5 * std::sin(arc) * std::sin(azimuth),
                           5 * std::cos(arc));
  };
  a.keeps = [](double u, double v) { return std::hypot(u, v) < 12.8; };
  a.surface = std::make_shared<SphereSurface>(5);
  return a;
}

TEST(FitSurface, domeOf75Degrees) {
  auto a = dome();
  EXPECT_LE(fit(a, 5e-4).surface.poles.size(), 130u);
}

AnalyticRegion bentTube() {
  AnalyticRegion a;
  a.columns = 60;
  a.rows = 80;
  a.firstU = 3;
  a.lastU = 15;
  a.lastV = 16;
  a.closed = true;
  a.point = [](double u, double v) {
    const double angle = 2 * M_PI * u / 12, bend = M_PI / 2 * v / 16;
    const double r = 3 + std::cos(angle);
    return Eigen::Vector3d(r * std::cos(bend), std::sin(angle), r * std::sin(bend));
  };
  return a;
}

TEST(FitSurface, bentTubeClosesBitByBit) {
  for (int turn : {0, 1}) {
    auto a = bentTube();
    a.turn = turn;
    const auto fitted = fit(a, 4e-3);
    const auto& s = fitted.surface;
    EXPECT_TRUE(s.closedU);
    EXPECT_EQ(s.lastU() - s.firstU(), 12);
    for (int j = 0; j < s.countV; ++j) EXPECT_EQ(s.pole(0, j), s.pole(s.countU - 1, j));
    const auto first = s.derivatives(s.firstU(), 5, 2), last = s.derivatives(s.lastU(), 5, 2);
    for (size_t k = 0; k < first.size(); ++k) EXPECT_LT((first[k] - last[k]).norm(), 1e-9) << k;
  }
}

TEST(FitSurface, planesAndCylindersNeedFewPoles) {
  AnalyticRegion plane;
  plane.point = [](double u, double v) { return Eigen::Vector3d(u + 0.3 * v, v, 0.5 * u); };
  EXPECT_LE(fit(plane, 1e-6).surface.poles.size(), 25u);
  AnalyticRegion cylinder = bentTube();
  cylinder.point = [](double u, double v) {
    return Eigen::Vector3d(2 * std::cos(2 * M_PI * u / 12), 2 * std::sin(2 * M_PI * u / 12), v);
  };
  cylinder.columns = 120;
  EXPECT_LE(fit(cylinder, 2e-3).surface.poles.size(), 100u);
}

TEST(FitSurface, roughParametersAreCorrected) {
  auto sheet = centredWavySheet();
  // Smooth distortion of over half a quad, and noise of a tenth of a triangle.
  sheet.chart = [](double u, double v) {
    return Eigen::Vector2d(
        u + 0.8 * std::sin(0.3 * v) + 0.3 * std::sin(0.7 * u) + 0.03 * std::sin(1e4 * u + 3e4 * v),
        v + 0.5 * std::cos(0.25 * u) + 0.03 * std::sin(2e4 * u - 1e4 * v));
  };
  EXPECT_LE(fit(sheet, 3e-4).surface.poles.size(), 1000u);
}

TEST(FitSurface, hundredRandomTrimsOfTheWavySheet) {
  std::mt19937 random(20);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int n = 0; n < int(sample::rounds(100)); ++n) {
    auto sheet = centredWavySheet(6);
    sheet.columns = sheet.rows = 60;
    const double size = 3 + 2.5 * uniform(random), lobes = 2 + std::floor(4 * uniform(random)),
                 depth = 0.5 * uniform(random), hole = 1.5 * uniform(random), turn = 6 * uniform(random),
                 aspect = 0.6 + 0.4 * uniform(random);
    sheet.keeps = [=](double u, double v) {
      const double x = u, y = v / aspect, r = std::hypot(x, y);
      return r < size * (1 + depth * std::cos(lobes * std::atan2(y, x) + turn)) / 1.5 &&
             r > std::min(hole, 0.25 * size * (1 - depth));
    };
    SCOPED_TRACE(n);
    std::optional<FittedSurface> fitted;
    ASSERT_NO_THROW(fitted = fit(sheet, 3e-4));
    EXPECT_LE(deviation(*fitted, sheet, 50).max, 4e-4);
    const double box = 30;
    for (const auto& p : fitted->surface.poles) EXPECT_LT(p.norm(), box);
  }
}

TEST(FitSurface, creasesObliqueToTheGridAreReachedByKnots) {
  AnalyticRegion roof;
  roof.columns = roof.rows = 60;
  roof.lastU = roof.lastV = 20;
  roof.point = [](double u, double v) { return Eigen::Vector3d(u, v, std::abs(u + 0.3 * v - 12)); };
  const auto fitted = fit(roof, sample::kSanitized ? 0.2 : 0.08);
  EXPECT_LE(fitted.surface.poles.size(), 3000u);
}

/// The largest distance of the fitted surface from a region that is no more than its triangles.
double farthest(const FittedSurface& fitted, const AnalyticRegion& a, int perSide) {
  const FittedRegion region(a.region, 0, 0);
  double result = 0;
  for (int i = 0; i < perSide; ++i)
    for (int j = 0; j < perSide; ++j) {
      const double u = a.firstU + (a.lastU - a.firstU) * (i + 0.5) / perSide,
                   v = a.firstV + (a.lastV - a.firstV) * (j + 0.5) / perSide;
      if (const auto there = region.farther(fitted.surface.jet(u, v), result)) result = there->distance;
    }
  return result;
}

TEST(FitSurface, ridgesBetweenSamplesKeepTheTolerance) {
  for (const double slope : {0.25, 0.31, 0.37}) {
    AnalyticRegion roof;
    roof.columns = roof.rows = 30;
    roof.lastU = roof.lastV = 10;
    roof.point = [=](double u, double v) {
      return Eigen::Vector3d(u, v, std::abs(u + slope * v - 6) + 0.5 * std::abs(u - slope * v - 3));
    };
    const double tolerance = 0.08;
    const auto fitted = fit(roof, tolerance);
    EXPECT_LE(farthest(fitted, roof, sample::fineness(600)), 1.005 * tolerance);
  }
}

TEST(FitSurface, unreachableTolerancesSayHowFarTheyCame) {
  AnalyticRegion roof;
  roof.columns = roof.rows = 4;
  roof.lastU = roof.lastV = 4;
  roof.point = [](double u, double v) { return Eigen::Vector3d(u, v, std::abs(u - 0.7 * v)); };
  roof.build();
  try {
    fitSurface(roof.region, roof.map, {.tolerance = 1e-4, .degree = 3}, Progress());
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), Error::Kind::Stage);
    EXPECT_NE(error.message().find("comes within"), std::string::npos);
  }
  EXPECT_THROW(fitSurface(roof.region, roof.map, {.tolerance = 0, .degree = 3}, Progress()), Error);
  EXPECT_THROW(fitSurface(roof.region, roof.map, {.tolerance = 1, .degree = 6}, Progress()), Error);
}

TEST(FitSurface, sameInputGivesTheSamePoles) {
  auto a = centredWavySheet(8), b = centredWavySheet(8);
  EXPECT_EQ(fit(a, 1e-3).surface.poles, fit(b, 1e-3).surface.poles);
}

TEST(FitSurface, cancels) {
  auto sheet = centredWavySheet();
  sheet.build();
  Progress progress;
  progress.cancel();
  EXPECT_THROW(fitSurface(sheet.region, sheet.map, {.tolerance = 1e-4, .degree = 3}, progress), Error);
}

TEST(FitSurface, isGivenUpBeyondSoManyPoles) {
  auto sheet = centredWavySheet();
  sheet.build();
  FitOptions options;
  options.tolerance = 1e-4;
  const auto fitted = fitSurface(sheet.region, sheet.map, options, Progress());
  options.maxPoles = int(fitted.surface.poles.size()) / 4;
  EXPECT_THROW(fitSurface(sheet.region, sheet.map, options, Progress()), Error);
  options.enough = 0.1;  // taken with as many
  EXPECT_LT(fitSurface(sheet.region, sheet.map, options, Progress()).surface.poles.size(),
            fitted.surface.poles.size());
}

TEST(FitSurface, isGivenUpBeyondSoMuchWorkOfItsOwn) {
  auto sheet = centredWavySheet();
  sheet.build();
  FitOptions options;
  options.tolerance = 1e-4;
  Progress progress;
  fitSurface(sheet.region, sheet.map, options, progress);
  const long work = progress.work();
  options.maxWork = work;
  fitSurface(sheet.region, sheet.map, options, progress);
  options.maxWork = 1;
  EXPECT_THROW(fitSurface(sheet.region, sheet.map, options, progress), Error);
  options.enough = 0.1;
  EXPECT_GT(fitSurface(sheet.region, sheet.map, options, progress).maxDeviation, 1e-4);
}

}  // namespace
}  // namespace trimquad
