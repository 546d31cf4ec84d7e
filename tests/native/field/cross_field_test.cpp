#include "trimquad/field/cross_field.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/sample_regions.h"
#include "trimquad/base/error.h"

namespace trimquad {
namespace {

std::vector<int> sortedTurns(const CrossField& field) {
  auto turns = field.loopTurns;
  std::sort(turns.begin(), turns.end());
  return turns;
}

TEST(CrossField, isUnitAndTangentialAndSmoothOnAWavySheet) {
  const Region r = sample::region(sample::sheet(30, 30, sample::wavy));
  const CrossField field = crossField(r, Progress());
  for (const auto f : r.mesh.faces()) {
    EXPECT_NEAR(field.direction[f.idx()].norm(), 1, 1e-12);
    EXPECT_NEAR(field.direction[f.idx()].dot(r.mesh.calc_face_normal(f)), 0, 1e-9);
  }
  for (const auto e : r.mesh.edges()) {
    if (r.mesh.is_boundary(e)) continue;
    const auto a = field.direction[r.mesh.face_handle(r.mesh.halfedge_handle(e, 0)).idx()],
               b = field.direction[r.mesh.face_handle(r.mesh.halfedge_handle(e, 1)).idx()];
    EXPECT_GT(a.dot(b), 0.8);
  }
  EXPECT_EQ(field.loopTurns, std::vector<int>{1});
}

TEST(CrossField, turnsOnceAroundAHoleInThePlane) {
  const Region r = sample::region(sample::sheet(20, 20, sample::flat, [](double s, double t) {
    return std::hypot(s - 0.3, t - 0.3) > 0.15 && std::hypot(s - 0.7, t - 0.6) > 0.2;
  }));
  const CrossField field = crossField(r, Progress());
  EXPECT_EQ(sortedTurns(field), (std::vector<int>{-1, -1, 1}));
  for (const auto& d : field.direction) EXPECT_GT(std::abs(d.dot(field.direction[0])), 1 - 1e-9);
}

TEST(CrossField, followsTheAxisOfATube) {
  const Region r = sample::region(sample::tube(24, 20, sample::cylinder));
  const CrossField field = crossField(r, Progress());
  EXPECT_EQ(sortedTurns(field), (std::vector<int>{0, 0}));
  for (const auto& d : field.direction) {
    const double along = std::abs(d.z());
    EXPECT_LT(std::min(along, 1 - along), 0.01);
  }
}

TEST(CrossField, tubeWithAHoleHasTwoEnds) {
  const Region r = sample::region(sample::tube(
      30, 20, sample::elbow, [](double s, double t) { return std::hypot(s - 0.5, t - 0.5) > 0.15; }));
  EXPECT_EQ(sortedTurns(crossField(r, Progress())), (std::vector<int>{-1, 0, 0}));
}

TEST(CrossField, followsPrincipalCurvatureOfASaddle) {
  // principal directions along the axes at the centre, and by symmetry along both axes' planes
  const Region r = sample::region(sample::sheet(24, 24, [](double s, double t) {
    const double x = s - 0.5, y = t - 0.5;
    return Eigen::Vector3d(x, y, x * x - y * y);
  }));
  const CrossField field = crossField(r, Progress());
  for (const auto f : r.mesh.faces()) {
    if (r.mesh.calc_face_centroid(f).norm() > 0.1) continue;
    const auto& d = field.direction[f.idx()];
    EXPECT_GT(std::max(std::abs(d.x()), std::abs(d.y())), 0.96);
  }
}

TEST(CrossField, needsABoundaryAndNoHandles) {
  TriangleSoup tetrahedron;
  tetrahedron.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  tetrahedron.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  EXPECT_THROW(crossField(sample::region(tetrahedron), Progress()), Error);

  TriangleSoup torus = sample::tube(12, 16, [](double s, double t) {
    const double a = 2 * M_PI * s, b = 2 * M_PI * t, radius = 3 + std::cos(a);
    return Eigen::Vector3d(radius * std::cos(b), radius * std::sin(b), -std::sin(a));
  });
  for (auto& t : torus.triangles)
    for (int& v : t) v %= 12 * 16;
  torus.points.resize(12 * 16);
  torus.triangles.pop_back();  // one hole in a surface of genus 1
  EXPECT_THROW(crossField(sample::region(torus), Progress()), Error);
}

TEST(CrossField, isTheSameForARotatedSurface) {
  const auto soup = sample::sheet(20, 20, sample::wavy);
  auto turned = soup;
  const Eigen::Matrix3d rotation =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  for (auto& p : turned.points) p = 1e3 * (rotation * p) + Eigen::Vector3d(5, 6, 7);
  const auto a = crossField(sample::region(soup), Progress()),
             b = crossField(sample::region(turned), Progress());
  for (size_t f = 0; f < a.direction.size(); ++f)
    EXPECT_NEAR((rotation * a.direction[f] - b.direction[f]).norm(), 0, 1e-4);
}

}  // namespace
}  // namespace trimquad
