#include "trimquad/spline/layout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "support/grid_maps.h"
#include "support/sample_maps.h"

namespace trimquad {
namespace {

double imageArea(const GridMap& map) {
  double area = 0;
  for (const auto f : map.mesh.faces()) {
    const auto h = map.mesh.halfedge_handle(f), n = map.mesh.next_halfedge_handle(h);
    const Eigen::Vector2d a = map.scale.toQuads(map.to(h) - map.from(h)),
                          b = map.scale.toQuads(map.to(n) - map.from(h));
    area += 0.5 * (a[0] * b[1] - a[1] * b[0]);
  }
  return area;
}

/// Outlines close, enclose the area of the map, and every border is used once in each direction by the
/// charts that it names; singularities lie on borders.
Layout checked(const GridMap& map, const std::vector<std::vector<int>>& bisections = {}) {
  const Layout result = layout(map, bisections, Progress());
  double area = 0;
  std::vector<std::set<bool>> uses(result.borders.size());
  for (int c = 0; c < int(result.charts.size()); ++c)
    for (const auto& loop : result.charts[c].loops) {
      std::vector<Eigen::Vector2d> polygon;
      std::vector<Eigen::Vector2d> ends;
      for (const auto& stretch : loop) {
        if (stretch.border) {
          const auto& border = result.borders[*stretch.border];
          const int side = stretch.forward ? 0 : 1;
          EXPECT_EQ(border.chart[side], c);
          EXPECT_TRUE(uses[*stretch.border].insert(stretch.forward).second);
          EXPECT_LT((Layout::apply(border.across, map.scale, border.start[0]) - border.start[1]).norm(),
                    1e-12);
          EXPECT_LT((Layout::apply(border.across, map.scale, border.end[0]) - border.end[1]).norm(), 1e-12);
          EXPECT_EQ((border.end[0] - border.start[0]).cwiseAbs().minCoeff(), 0);
          polygon.push_back(side == 0 ? border.start[0] : border.end[1]);
          ends.push_back(side == 0 ? border.end[0] : border.start[1]);
        } else {
          for (const auto& p : stretch.boundary) polygon.push_back(p.at);
          ends.push_back(polygon.back());
          polygon.pop_back();
        }
      }
      std::size_t at = 0;
      for (std::size_t i = 0; i < loop.size(); ++i) {
        at += loop[i].border ? 1 : loop[i].boundary.size() - 1;
        EXPECT_LT((ends[i] - polygon[at % polygon.size()]).norm(), 1e-9);
      }
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const auto &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
        area += 0.5 * (p[0] * q[1] - p[1] * q[0]);
      }
    }
  for (const auto& use : uses) EXPECT_EQ(use.size(), 2u);
  EXPECT_NEAR(area, imageArea(map), 1e-6 * area);
  return result;
}

/// Quarters of the plane through which a stretch of a hole's boundary runs.
int turnsAround(const Layout::Stretch& stretch) {
  double turn = 0;
  const auto& b = stretch.boundary;
  for (std::size_t i = 2; i < b.size(); ++i) {
    const Eigen::Vector2d p = b[i - 1].at - b[i - 2].at, q = b[i].at - b[i - 1].at;
    turn -= std::atan2(p[0] * q[1] - p[1] * q[0], p.dot(q));
  }
  return int(std::ceil(turn / (M_PI / 2) - 0.1));
}

TEST(Layout, aCubeConsistsOfItsSixSides) {
  for (const int quads : {1, 2, 3}) {
    const Layout cube = checked(sample::boxesMap({{0, 0, 0}}, 4, quads));
    EXPECT_EQ(cube.charts.size(), 6u) << quads;
    EXPECT_EQ(cube.borders.size(), 12u);
  }
}

TEST(Layout, tubesAndToriAreCutIntoChartsThatDoNotBorderThemselves) {
  EXPECT_EQ(checked(samples::gridMapOf(samples::wrapped(16, 12, 0.5, 0.5, true))).charts.size(), 4u);
  EXPECT_EQ(checked(samples::gridMapOf(samples::wrapped(16, 12, 0.5, 0.5, false))).charts.size(), 2u);
}

TEST(Layout, conesHaveTheSingularityOnBorders) {
  for (const int quarters : {3, 5, 6, 8}) {
    const Layout cone = checked(samples::gridMapOf(samples::cone(quarters, 5, 3.3)));
    EXPECT_EQ(cone.charts.size(), unsigned(quarters));
    int singular = 0;
    for (const auto& p : cone.points) singular += p.inner() && p.quarters != 4;
    EXPECT_EQ(singular, 1);
    // A hole in place of the singularity: no chart goes around more than half of it.
    const Layout holed = checked(samples::gridMapOf(samples::cone(quarters, 6, 3.3, 3)));
    for (const auto& chart : holed.charts)
      for (const auto& loop : chart.loops)
        for (const auto& stretch : loop) EXPECT_LE(turnsAround(stretch), 2) << quarters;
  }
}

TEST(Layout, ringOfBoxes) {
  std::vector<std::array<int, 3>> ring;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (i != 1 || j != 1) ring.push_back({i, j, 0});
  const Layout result = checked(sample::boxesMap(ring, 4, 2));
  EXPECT_LE(result.charts.size(), 24u);
}

TEST(Layout, aFlatSheetIsOneChart) {
  const auto map = samples::planarMap(samples::sheet(
      12, 12, [](int i, int j) { return Eigen::Vector2d(0.37 * i, 0.41 * j); },
      [](int i, int j) { return i > 3 && i < 8 && j > 2 && j < 7; }));
  EXPECT_EQ(checked(map).charts.size(), 1u);
}

TEST(Layout, aChartIsCutInTwoWhereItBendsMost) {
  // Flat but for a half cylinder over 7 < u < 11.
  const auto map = samples::planarMap(samples::sheet(
      16, 12, [](int i, int j) { return Eigen::Vector2d(i + 0.1, j + 0.2); },
      [](int, int) { return false; }));
  GridMap bent = map;
  for (const auto v : bent.mesh.vertices()) {
    const auto p = bent.mesh.point(v);
    const double turn = M_PI * std::clamp((p[0] - 7) / 4, 0.0, 1.0), r = 4 / M_PI;
    const double flat = std::min(p[0], 7.0), beyond = std::max(p[0] - 11, 0.0);
    bent.mesh.set_point(v, {flat + r * std::sin(turn) - beyond, p[1], r * (1 - std::cos(turn))});
  }
  EXPECT_EQ(checked(bent).charts.size(), 1u);
  const Layout cut = checked(bent, {{0}});
  ASSERT_EQ(cut.charts.size(), 2u);
  ASSERT_EQ(cut.borders.size(), 1u);
  EXPECT_EQ(cut.borders[0].start[0][0], 9);
  EXPECT_EQ(cut.borders[0].end[0][0], 9);
  EXPECT_EQ(checked(bent, {{0}, {0, 1}}).charts.size(), 4u);
}

}  // namespace
}  // namespace trimquad
