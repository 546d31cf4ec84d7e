#include "trimquad/gridmap/grid_map.h"

#include <gtest/gtest.h>

#include <random>

#include "support/sample_regions.h"
#include "trimquad/base/error.h"
#include "trimquad/field/curvature_guidance.h"
#include "trimquad/field/singularity_free_field.h"
#include "trimquad/mesh/boundary_image.h"
#include "trimquad/tmesh/partition.h"

namespace trimquad {
namespace {

CrossField fieldOf(const Region& r) {
  return singularityFreeField(r.mesh, curvatureGuidance(r, Progress()), 4, Progress());
}

GridMap mapOf(const Region& r, double edgeLength) {
  const CrossField field = fieldOf(r);
  const SeamlessMap seamless = seamlessMap(r, field, edgeLength, Effort::Full, Progress());
  const TMesh tmesh = partition(seamless, Progress());
  return gridMap(seamless, tmesh, quantize(tmesh, {}, Progress()), true, Progress());
}

/// Translation of the seam that a tube's map has, in quads (as long as it has one).
Eigen::Vector2d period(const GridMap& map) {
  for (const auto h : map.mesh.halfedges()) {
    if (map.mesh.is_boundary(map.mesh.edge_handle(h))) continue;
    const auto t = map.transition(h);
    if (!t.isIdentity()) return map.scale.toQuads(t.translation);
  }
  return {0, 0};
}

TEST(GridMap, flatSheetIsAnIsometry) {
  const GridMap map = mapOf(sample::region(sample::sheet(10, 10, sample::flat)), 0.1);
  EXPECT_NEAR(map.counters.distortionEnd, 4, 1e-9);
  EXPECT_EQ(map.counters.flippedBefore, 0);
}

TEST(GridMap, wavySheetIsValidAndNearlyIsometric) {
  const GridMap map = mapOf(sample::region(sample::sheet(40, 40, sample::wavy)), 0.3);
  verify(map, true);
  EXPECT_LT(map.counters.distortionEnd, 4.8);
}

TEST(GridMap, tubeHasAWholePeriodAlongOneAxis) {
  for (const auto& shape : {sample::cylinder, sample::elbow}) {
    const GridMap map = mapOf(sample::region(sample::tube(40, 30, shape)), 0.23);
    const Eigen::Vector2d t = period(map);
    EXPECT_EQ(std::min(std::abs(t.x()), std::abs(t.y())), 0);
    const double whole = std::max(std::abs(t.x()), std::abs(t.y()));
    EXPECT_EQ(whole, std::round(whole));
    EXPECT_NEAR(whole, 2 * M_PI / 0.23, 4);
  }
}

TEST(GridMap, tubeThinnerThanAQuadHasThreeAround) {
  const GridMap map = mapOf(sample::region(sample::tube(24, 12, sample::cylinder)), 30);
  const Eigen::Vector2d t = period(map);
  EXPECT_EQ(std::max(std::abs(t.x()), std::abs(t.y())), 3);
}

TEST(GridMap, holesLeaveTheMapInOneChart) {
  const GridMap map = mapOf(sample::region(sample::sheet(40, 40, sample::wavy,
                                                         [](double s, double t) {
                                                           return std::hypot(s - 0.3, t - 0.3) > 0.1 &&
                                                                  std::hypot(s - 0.7, t - 0.6) > 0.15;
                                                         })),
                            0.3);
  EXPECT_EQ(period(map), Eigen::Vector2d(0, 0));
}

TEST(GridMap, holesOfATubeKeepTheirPlaces) {
  // Their rims lie anywhere between the grid lines; only once around is it a whole number of quads.
  const auto inside = [](double s, double t) {
    for (const double hole : {0.11, 0.29, 0.52, 0.77})
      if (std::hypot(s - hole, 0.4 * (t - hole)) < 0.06) return false;
    return true;
  };
  for (const auto& shape : {sample::cylinder, sample::elbow})
    for (const double edgeLength : {0.1, 0.23, 0.61}) {
      const GridMap map = mapOf(sample::region(sample::tube(60, 40, shape, inside)), edgeLength);
      const Eigen::Vector2d around = period(map).cwiseAbs();
      EXPECT_EQ(around.minCoeff(), 0);
      for (const auto h : map.mesh.halfedges()) {
        if (map.mesh.is_boundary(map.mesh.edge_handle(h))) continue;
        const auto t = map.transition(h);
        EXPECT_EQ(t.rotation, 0);
        if (t.isIdentity()) continue;
        EXPECT_EQ(map.scale.toQuads(t.translation).cwiseAbs(), around);
      }
    }
}

TEST(GridMap, domeBeyondTheEquatorUntangles) {
  for (const double degrees : {60.0, 90.0, 120.0}) {
    const GridMap map = mapOf(
        sample::region(sample::sheet(30, 30, sample::dome(degrees / 180 * M_PI / std::sqrt(2.0)))), 0.1);
    verify(map, true);
  }
}

bool boundaryTouchesItself(const SeamlessMap& map) {
  std::vector<BoundarySegment> segments;
  for (const auto& loop : boundaryLoops(map.mesh))
    for (size_t i = 0; i < loop.size(); ++i) {
      const auto inner = map.mesh.opposite_halfedge_handle(loop[loop.size() - 1 - i]);
      segments.push_back({map.from(inner), map.to(inner), int((i + 1) % loop.size())});
    }
  return firstContact(segments, std::nullopt).has_value();
}

/// A ramp that rises a little while it turns; developed, it lies over itself from a full turn on.
Region ramp(double turns, int along, int across) {
  return sample::region(sample::sheet(along, across, [&](double s, double t) {
    const double a = 2 * turns * M_PI * s, radius = 2 - t;
    return Eigen::Vector3d(radius * std::cos(a), radius * std::sin(a), 0.1 * a);
  }));
}

TEST(GridMap, spiralRampIsUnrolledWithoutCoveringThePlaneTwice) {
  const Region r = ramp(1.5, 90, 8);
  const SeamlessMap map = seamlessMap(r, fieldOf(r), 0.1, Effort::Full, Progress());
  EXPECT_TRUE(map.counters.scaffolded);
  verify(map, false);
  EXPECT_FALSE(boundaryTouchesItself(map));
}

/// Least distance between parts of the boundary's image that lie far apart along it, quads.
double narrowestGap(const SeamlessMap& map) {
  std::vector<Eigen::Vector2d> points;
  const auto loop = boundaryLoops(map.mesh).front();
  for (const auto h : loop)
    points.push_back(
        map.scale.toQuads(map.from(map.mesh.next_halfedge_handle(map.mesh.opposite_halfedge_handle(h)))));
  const int n = int(points.size());
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < n; ++i)
    for (int j = i + n / 4; j < n && j - i < n - n / 4; ++j)
      least = std::min(least, (points[i] - points[j]).norm());
  return least;
}

TEST(GridMap, rampThatJustOverlapsIsBentApartALittle) {
  // Its ends are to stay so far apart that a surface can get from one to the other.
  const Region r = ramp(1.05, 120, 16);
  const SeamlessMap map = seamlessMap(r, fieldOf(r), 0.1, Effort::Full, Progress());
  EXPECT_TRUE(map.counters.scaffolded);
  EXPECT_FALSE(boundaryTouchesItself(map));
  EXPECT_LT(map.counters.distortionEnd, 4.01);
  EXPECT_GT(narrowestGap(map), 0.3);
}

TEST(GridMap, whatCannotBeUnrolledWithoutGreatDistortionStaysAsItIs) {
  // A cone of five turns around nearly its apex: one sheet without overlap would be torn out of shape.
  const Region r = sample::region(sample::sheet(400, 12, [](double s, double t) {
    const double a = 10 * M_PI * s, radius = 0.05 + 2 * t * t;
    return Eigen::Vector3d(radius * std::cos(a), radius * std::sin(a), 0.02 * a);
  }));
  const SeamlessMap map = seamlessMap(r, fieldOf(r), 0.1, Effort::Full, Progress());
  EXPECT_FALSE(map.counters.scaffolded);
  EXPECT_LT(map.counters.distortionEnd, 4.1);
  EXPECT_TRUE(boundaryTouchesItself(map));
  verify(map, false);
}

TEST(GridMap, roughRandomSurfacesAlwaysGetAValidMap) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, 0.02 * double(seed % 10));
    const int n = 4 + int(random() % 8);
    const bool closed = seed % 3 == 0;
    auto soup = closed ? sample::tube(n + 3, n, sample::cylinder) : sample::sheet(n, n, sample::flat);
    for (auto& p : soup.points) p += Eigen::Vector3d(noise(random), noise(random), noise(random));
    verify(mapOf(sample::region(soup), 0.05 + 0.1 * double(random() % 5)), true);
  }
}

TEST(GridMap, isTheSameFromRunToRun) {
  const Region r = sample::region(sample::tube(30, 30, sample::elbow));
  EXPECT_EQ(mapOf(r, 0.2).corner, mapOf(r, 0.2).corner);
}

TEST(GridMap, stopsWhenCancelled) {
  const Region r = sample::region(sample::sheet(30, 30, sample::wavy));
  const CrossField field = fieldOf(r);
  Progress progress;
  progress.cancel();
  EXPECT_THROW(seamlessMap(r, field, 0.2, Effort::Full, progress), Error);
}

}  // namespace
}  // namespace trimquad
