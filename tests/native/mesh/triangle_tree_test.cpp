#include <Eigen/Geometry>

#include "support/error_of.h"
#include "support/mesh_samples.h"
#include "trimquad/mesh/aabb_tree.h"

namespace trimquad {
namespace {

/// The smallest squared distance, by looking at points of every triangle: by projection and on every side.
double bruteForce(const TriangleSoup& soup, const Eigen::Vector3d& p) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& t : soup.triangles) {
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d a = soup.points[t[k]], d = soup.points[t[(k + 1) % 3]] - a;
      const double s = d.squaredNorm() > 0 ? std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0;
      least = std::min(least, (a + s * d - p).squaredNorm());
    }
    const Eigen::Vector3d a = soup.points[t[0]], n = (soup.points[t[1]] - a).cross(soup.points[t[2]] - a);
    if (n.isZero()) continue;
    const Eigen::Vector3d foot = p - n * (n.dot(p - a) / n.squaredNorm());
    bool inside = true;
    for (int k = 0; k < 3; ++k)
      inside = inside &&
               (soup.points[t[(k + 1) % 3]] - soup.points[t[k]]).cross(foot - soup.points[t[k]]).dot(n) >= 0;
    if (inside) least = std::min(least, (foot - p).squaredNorm());
  }
  return least;
}

TEST(TriangleTree, findsTheClosestPointOfRandomTriangles) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  const auto point = [&] {
    return Eigen::Vector3d(coordinate(random), coordinate(random), coordinate(random));
  };
  for (int round = 0; round < 20; ++round) {
    TriangleSoup soup;
    for (int i = 0; i < 60; ++i) soup.points.push_back(point());
    for (int t = 0; t < 1 + 10 * round; ++t)  // some with repeated corners
      soup.triangles.push_back({int(random() % 60), int(random() % 60), int(random() % 60)});
    const TriangleTree tree(soup.points, soup.triangles);
    for (int q = 0; q < 50; ++q) {
      const Eigen::Vector3d p = 2 * point();
      const auto hit = tree.closest(p);
      EXPECT_NEAR(hit.squaredDistance, bruteForce(soup, p), 1e-12);
      const auto& t = soup.triangles[hit.triangle];
      const Eigen::Vector3d blend = hit.barycentric[0] * soup.points[t[0]] +
                                    hit.barycentric[1] * soup.points[t[1]] +
                                    hit.barycentric[2] * soup.points[t[2]];
      EXPECT_LT((blend - hit.point).norm(), 1e-14);
      EXPECT_NEAR(hit.barycentric.sum(), 1, 1e-14);
      EXPECT_GE(hit.barycentric.minCoeff(), 0);
    }
  }
}

TEST(TriangleTree, pointsOfTheSurfaceAreTheirOwnFeet) {
  const TriangleSoup soup = sphere(5, 4);
  const TriangleTree tree(soup.points, soup.triangles);
  for (const auto& p : soup.points) EXPECT_EQ(tree.closest(p).squaredDistance, 0);
}

TEST(TriangleTree, manyEqualTrianglesDoNotBreakTheTree) {
  TriangleSoup soup;
  soup.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  soup.triangles.assign(1000, {0, 1, 2});
  EXPECT_EQ(TriangleTree(soup.points, soup.triangles).closest({0.25, 0.25, 2}).squaredDistance, 4);
}

TEST(TriangleTree, tellsTheSidesOfAThinPlateApart) {
  const TriangleTree plate({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, -0.1}, {4, 0, -0.1}, {0, 4, -0.1}},
                           {{0, 1, 2}, {3, 5, 4}});
  EXPECT_EQ(plate.closestFacing({1, 1, -0.08}, {0, 0, 1})->triangle, 0);
  EXPECT_EQ(plate.closestFacing({1, 1, -0.02}, {0, 0, -1})->triangle, 1);
  EXPECT_FALSE(plate.closestFacing({1, 1, 0}, {1, 0, 0}));
  EXPECT_FALSE(plate.closestFacing({1, 1, 0}, {0, 0, 0}));
}

TEST(TriangleTree, needsATriangle) {
  EXPECT_TRUE(errorOf([] { TriangleTree({{0, 0, 0}}, {}); }));
}

}  // namespace
}  // namespace trimquad
