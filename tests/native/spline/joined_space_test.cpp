#include "trimquad/spline/joined_space.h"

#include <gtest/gtest.h>

#include <random>

#include "support/sample_maps.h"

namespace trimquad {
namespace {

/// A torus with holes narrower than a quad, which the borders between its charts run across.
GridMap piercedTorus() {
  const int columns = 36, rows = 24;
  const auto whole = samples::wrapped(columns, rows, 0.5, 0.5, true, {0.25, 0.25});
  samples::MappedSoup pierced;
  pierced.soup.points = whole.soup.points;
  for (int t = 0; t < int(whole.soup.triangles.size()); ++t) {
    const int i = t / 2 % columns, j = t / 2 / columns;
    if (i % 3 == 1 && j % 3 == 1) continue;
    pierced.add(whole.soup.triangles[t], whole.corners[t]);
  }
  return samples::gridMapOf(pierced);
}

TEST(JoinedSpace, bordersAgreeToRoundingAcrossHolesWhateverTheKnotsOfBothSides) {
  const GridMap map = piercedTorus();
  const Layout charts = layout(map, {}, Progress());
  std::mt19937 random(5);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (int run = 0; run < 5; ++run) {
    JoinedSpace space(charts);
    std::vector<std::vector<Datum>> data;
    for (const auto& chart : charts.charts) {
      SplineLine lines[2];
      for (int axis : {0, 1}) {
        // Bisected here and there, otherwise on each side of a border.
        std::vector<double>& at = lines[axis].breaks;
        at = {std::floor(chart.low[axis] - 1), std::ceil(chart.high[axis] + 1)};
        for (int k = 0; k < 14; ++k) {
          const int i = int(between(0, double(at.size() - 1)));
          if (at[i + 1] - at[i] > 0.05) at.insert(at.begin() + i + 1, (at[i] + at[i + 1]) / 2);
        }
      }
      space.charts.push_back({lines[0], lines[1]});
      auto& own = data.emplace_back();
      for (int k = 0; k < 4000; ++k) {
        const Eigen::Vector2d x(between(chart.low[0], chart.high[0]), between(chart.low[1], chart.high[1]));
        own.push_back({x, {x[0], x[1], between(-1, 1)}, 0.01});
      }
    }
    const auto surfaces = space.leastSquares(data, {1e-3, 1e-3}, Progress());
    ASSERT_TRUE(surfaces);
    int onBoundary = 0;
    double gap = 0, kink = 0;
    for (const auto& border : charts.borders) {
      onBoundary += !charts.points[border.startPoint].inner() && !charts.points[border.endPoint].inner();
      for (double s = 0; s <= 1; s += 1.0 / 64) {
        SplineSurface::Jet jet[2];
        for (int k : {0, 1}) {
          const Eigen::Vector2d x = border.start[k] + s * (border.end[k] - border.start[k]);
          jet[k] = (*surfaces)[border.chart[k]].jet(x[0], x[1]);
        }
        gap = std::max(gap, (jet[0].s - jet[1].s).norm());
        kink = std::max(kink, (jet[0].su.cross(jet[0].sv) - jet[1].su.cross(jet[1].sv)).norm());
      }
    }
    EXPECT_GT(onBoundary, 4);
    EXPECT_LT(gap, 1e-9) << run;
    EXPECT_LT(kink, 1e-8) << run;
  }
}

/// Root mean square of the distances from the data.
double residual(const std::vector<SplineSurface>& surfaces, const std::vector<std::vector<Datum>>& data) {
  double sum = 0;
  int count = 0;
  for (std::size_t c = 0; c < data.size(); ++c)
    for (const auto& d : data[c]) {
      sum += (surfaces[c].point(d.parameter[0], d.parameter[1]) - d.point).squaredNorm();
      ++count;
    }
  return std::sqrt(sum / count);
}

TEST(JoinedSpace, narrowSpansBesideBordersLeaveTheDataTheirDigits) {
  const GridMap map = samples::gridMapOf(samples::wrapped(36, 24, 0.5, 0.5, true, {0.25, 0.25}));
  const Layout charts = layout(map, {}, Progress());
  // Periodic as the torus is: 18 by 12 quads.
  const auto wave = [](const Eigen::Vector2d& x) {
    const double a = 2 * M_PI * x[0] / 18, b = 2 * M_PI * x[1] / 12;
    return Eigen::Vector3d(std::cos(a), std::cos(b), std::sin(a + b));
  };
  std::vector<std::vector<Datum>> data;
  for (const auto& chart : charts.charts) {
    auto& own = data.emplace_back();
    for (double u = chart.low[0] + 0.05; u < chart.high[0]; u += 0.1)
      for (double v = chart.low[1] + 0.05; v < chart.high[1]; v += 0.1)
        own.push_back({{u, v}, wave({u, v}), 0.01});
  }
  const auto fitted = [&](double narrow) {
    JoinedSpace space(charts);
    for (const auto& chart : charts.charts) {
      SplineLine lines[2];
      for (int axis : {0, 1}) {
        auto& at = lines[axis].breaks;
        for (double x = chart.low[axis]; x <= chart.high[axis]; ++x) at.push_back(x);
        if (narrow > 0) {
          at.insert(at.begin() + 1, at.front() + narrow);
          at.insert(at.end() - 1, at.back() - narrow);
        }
      }
      space.charts.push_back({lines[0], lines[1]});
    }
    return residual(*space.leastSquares(data, {1e-11, 1e-9}, Progress()), data);
  };
  const double coarse = fitted(0);
  EXPECT_LT(coarse, 1e-3);
  for (const double narrow : {0.1, 0.01, 0.001}) EXPECT_LE(fitted(narrow), 1.01 * coarse) << narrow;
}

}  // namespace
}  // namespace trimquad
