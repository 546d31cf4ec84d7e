#include "trimquad/spline/chart.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <string>

#include "support/analytic_region.h"
#include "trimquad/base/error.h"

namespace trimquad {
namespace {

AnalyticRegion flat(std::function<bool(double, double)> keeps) {
  AnalyticRegion a;
  a.point = [](double u, double v) { return Eigen::Vector3d(u, v, 0); };
  a.keeps = std::move(keeps);
  a.build();
  return a;
}

/// A strip that winds around in the plane through `turns`, wide enough to cover itself after more than one.
AnalyticRegion spiral(double turns) {
  AnalyticRegion a;
  a.columns = 80;
  a.rows = 2;
  a.lastU = 1;
  a.lastV = 1;
  a.point = [](double u, double v) { return Eigen::Vector3d(u, v, 0); };
  a.chart = [=](double u, double v) {
    const double angle = 2 * M_PI * turns * u, radius = 4 - v;
    return Eigen::Vector2d(radius * std::cos(angle), radius * std::sin(angle));
  };
  a.build();
  return a;
}

std::string refusal(const GridMap& map) {
  try {
    chart(map);
  } catch (const Error& error) {
    EXPECT_EQ(error.stage(), "fit");
    return error.message();
  }
  return {};
}

TEST(Chart, diskWithHolesIsOnePlane) {
  const auto a = flat([](double u, double v) {
    return !(u > 2 && u < 4 && v > 3 && v < 7) && !(u > 6 && v > 6 && u < 8 && v < 8);
  });
  const auto c = chart(a.map);
  EXPECT_FALSE(c.period);
  EXPECT_EQ(c.corner, a.map.corner);
}

TEST(Chart, transitionsInsideADiskDisappear) {
  // The right half's chart is turned and moved; unrolling undoes it.
  auto a = flat([](double, double) { return true; });
  const auto straight = a.map.corner;
  const FixedVector shift{a.map.scale.round(7), a.map.scale.round(-3)};
  for (const auto f : a.map.mesh.faces())
    if (a.map.mesh.calc_face_centroid(f).x() > 5)
      for (const auto h : a.map.mesh.fh_range(f))
        a.map.corner[h.idx()] = rotated(a.map.corner[h.idx()], 3) + shift;
  EXPECT_EQ(chart(a.map).corner, straight);
}

TEST(Chart, tubeHasItsPeriodInU) {
  for (int turn = 0; turn < 4; ++turn) {
    AnalyticRegion a;
    a.closed = true;
    a.turn = turn;
    a.point = [](double u, double v) {
      return Eigen::Vector3d(std::cos(0.2 * M_PI * u), std::sin(0.2 * M_PI * u), v);
    };
    a.keeps = [](double u, double v) { return std::hypot(u - 9, v - 5) > 2; };
    a.build();
    const auto c = chart(a.map);
    ASSERT_TRUE(c.period);
    EXPECT_EQ(*c.period, 10 * c.scale.one());
  }
}

TEST(Chart, overlapsAreFoundExactly) {
  EXPECT_EQ(refusal(spiral(0.9).map), "");
  EXPECT_NE(refusal(spiral(1.1).map).find("twice"), std::string::npos);
  EXPECT_NE(refusal(spiral(1.0).map).find("twice"), std::string::npos) << "touching counts";
}

TEST(Chart, tubeThatOverlapsItselfOnlyAroundIsRefused) {
  // A tongue on the upper end of a tube leans over so far that, a period on, it covers the tube's other side
  // of the gap.
  AnalyticRegion a;
  a.closed = true;
  a.columns = 20;
  a.rows = 20;
  a.point = [](double u, double v) {
    return Eigen::Vector3d(std::cos(0.2 * M_PI * u), std::sin(0.2 * M_PI * u), v);
  };
  a.keeps = [](double u, double v) { return v < 5 || (u > 2 && u < 4) || (u > 6 && u < 8); };
  for (const double lean : {0.9, 3.0}) {
    a.chart = [=](double u, double v) {
      return Eigen::Vector2d(u + (u > 1 && u < 5 && v > 5 ? lean * (v - 5) * 0.4 : 0), v);
    };
    a.build();
    EXPECT_EQ(refusal(a.map).empty(), lean == 0.9);
  }
}

TEST(Chart, singularitiesAreRefused) {
  // Three quarters of a square around a corner, the two free sides joined: a cone of three quarter turns.
  TriangleSoup soup;
  for (const auto& p : {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(-0.5, 0.9, 0),
                        Eigen::Vector3d(-0.5, -0.9, 0)})
    soup.points.push_back(p);
  soup.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}};
  GridMap map;
  map.mesh = buildSurfaceMesh(soup);
  map.scale = FixedScale{30};
  map.corner.resize(map.mesh.n_halfedges());
  const Quanta one = map.scale.one();
  const FixedVector image[3] = {{0, 0}, {one, 0}, {0, one}};
  for (const auto f : map.mesh.faces())
    for (const auto h : map.mesh.fh_range(f))
      for (int k = 0; k < 3; ++k)
        if (soup.triangles[f.idx()][k] == map.mesh.from_vertex_handle(h).idx())
          map.corner[h.idx()] = image[k];
  EXPECT_NE(refusal(map).find("singularity"), std::string::npos);
}

TEST(Chart, aRectangleAtAnAngleIsTurnedIntoItsOwnDirections) {
  auto a = flat([](double, double) { return true; });
  const double angle = 33 * M_PI / 180;
  for (auto& x : a.map.corner) {
    const Eigen::Vector2d y = a.map.scale.toQuads(x);
    x = a.map.scale.round(Eigen::Vector2d(4 * std::cos(angle) * y[0] - std::sin(angle) * y[1],
                                          4 * std::sin(angle) * y[0] + std::cos(angle) * y[1]));
  }
  const auto turned = turnedToSmallestRectangle(chart(a.map), a.map.mesh);
  Eigen::AlignedBox2d box;
  for (const auto f : a.map.mesh.faces())
    for (const auto h : a.map.mesh.fh_range(f)) box.extend(turned.scale.toQuads(turned.corner[h.idx()]));
  EXPECT_NEAR(box.volume(), 400, 1e-3);
}

}  // namespace
}  // namespace trimquad
