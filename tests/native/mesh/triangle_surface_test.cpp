#include "trimquad/mesh/triangle_surface.h"

#include "support/mesh_samples.h"

namespace trimquad {
namespace {

TEST(TriangleSurface, footLiesOnTheTrianglesWithTheirNormal) {
  const TriangleSurface surface(buildSurfaceMesh(sphere(2, 4)));
  std::mt19937 random(5);
  std::normal_distribution<double> gauss;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d direction =
        Eigen::Vector3d(gauss(random), gauss(random), gauss(random)).normalized();
    const auto foot = surface.closest(2.1 * direction);
    EXPECT_NEAR(foot.point.norm(), 2, 0.01);
    EXPECT_GT(foot.normal.dot(direction), 0.99);
    EXPECT_NEAR(foot.normal.norm(), 1, 1e-14);
  }
}

TEST(TriangleSurface, aSphereCurvesAlikeInAllDirections) {
  const TriangleSurface surface(buildSurfaceMesh(sphere(2, 5)));
  for (const Eigen::Vector3d& p :
       {Eigen::Vector3d(2, 0, 0), Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(0, -1.2, 1.6)}) {
    const auto curvature = surface.curvature(p);
    EXPECT_NEAR(curvature.k1, -0.5, 0.01);
    EXPECT_NEAR(curvature.k2, -0.5, 0.01);
  }
}

TEST(TriangleSurface, aCylinderIsStraightAlongItsAxis) {
  const double radius = 3;
  const auto mesh = buildSurfaceMesh(sheet(60, 20, [&](double i, double j) {
    const double a = 2 * i / 60;
    return Eigen::Vector3d(radius * std::cos(a), radius * std::sin(a), j / 5);
  }));
  const TriangleSurface surface(mesh);
  // Inside, on the boundary and in a corner, where the neighbours lie on one side only.
  for (const auto& [a, z] : {std::pair(1.0, 2.0), {1.3, 1.1}, {1.0, 0.0}, {0.0, 2.0}, {0.0, 0.0}}) {
    const auto c = surface.curvature({radius * std::cos(a), radius * std::sin(a), z});
    EXPECT_NEAR(c.k1, 0, 0.02);
    EXPECT_NEAR(c.k2, -1 / radius, 0.02);
    EXPECT_GT(std::abs(c.direction1.z()), 0.999);
    EXPECT_LT(std::abs(c.direction2.z()), 0.03);
    EXPECT_NEAR(c.direction1.dot(c.direction2), 0, 1e-12);
  }
}

TEST(TriangleSurface, aSaddleBendsBothWays) {
  const TriangleSurface surface(buildSurfaceMesh(sheet(40, 40, [](double i, double j) {
    const double x = i / 20 - 1, y = j / 20 - 1;
    return Eigen::Vector3d(x, y, x * x / 2 - y * y);
  })));
  const auto c = surface.curvature({0, 0, 0});
  EXPECT_NEAR(c.k1, 1, 0.01);
  EXPECT_NEAR(c.k2, -2, 0.02);
  EXPECT_GT(std::abs(c.direction1.x()), 0.999);
}

TEST(TriangleSurface, curvatureScalesInverselyAndIsFiniteOnTheSmallestMeshes) {
  for (const double scale : {1e-6, 1e6}) {
    const auto c = TriangleSurface(buildSurfaceMesh(sphere(scale, 4))).curvature({scale, 0, 0});
    EXPECT_NEAR(c.k1 * scale, -1, 0.05);
  }
  const auto c = TriangleSurface(buildSurfaceMesh(flatSheet(1, 1))).curvature({0.5, 0.5, 1});
  EXPECT_NEAR(c.k1, 0, 1e-12);
  EXPECT_NEAR(c.k2, 0, 1e-12);
}

}  // namespace
}  // namespace trimquad
