#include "trimquad/field/singularity_free_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "support/sample_regions.h"
#include "trimquad/field/curvature_guidance.h"

namespace trimquad {
namespace {

CrossField smoothField(const Region& r) {
  return singularityFreeField(r.mesh, curvatureGuidance(r, Progress()), 4, Progress());
}

std::vector<int> sortedTurns(const CrossField& field) {
  auto turns = field.loopTurns;
  std::sort(turns.begin(), turns.end());
  return turns;
}

/// How often a loop turns against the field, from the directions alone: exterior angles less the field's
/// smallest rotations from triangle to triangle.
int turnsAgainst(const Region& r, const CrossField& field, const std::vector<HalfedgeHandle>& loop) {
  const auto& mesh = r.mesh;
  const auto against = [&](FaceHandle f, HalfedgeHandle h) {
    const Eigen::Vector3d e = mesh.point(mesh.to_vertex_handle(h)) - mesh.point(mesh.from_vertex_handle(h)),
                          d = field.direction[f.idx()];
    return std::atan2(e.cross(d).dot(mesh.calc_face_normal(f)), e.dot(d));
  };
  double turn = 0;
  for (const auto b : loop) {
    turn += M_PI;
    // Clockwise around the vertex that b leaves, from the inner halfedge that enters it on.
    HalfedgeHandle h = mesh.next_halfedge_handle(mesh.opposite_halfedge_handle(b));
    for (;;) {
      turn -= cornerAngle(mesh, h);
      const auto o = mesh.opposite_halfedge_handle(h);
      if (mesh.is_boundary(o)) break;
      turn -= std::remainder(against(mesh.face_handle(o), h) - against(mesh.face_handle(h), h), 2 * M_PI);
      h = mesh.next_halfedge_handle(o);
    }
  }
  EXPECT_NEAR(turn / (2 * M_PI), std::round(turn / (2 * M_PI)), 1e-6);
  return int(std::lround(turn / (2 * M_PI)));
}

TEST(SingularityFreeField, turnsAroundEachLoopAsOftenAsItSays) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(0.2, 0.8);
    std::vector<Eigen::Vector2d> holes;
    for (unsigned k = 0; k < seed % 4; ++k) holes.emplace_back(place(random), place(random));
    const auto inside = [&](double s, double t) {
      for (const auto& hole : holes)
        if (std::max(std::abs(s - hole.x()), std::abs(t - hole.y())) < 0.1) return false;
      return true;
    };
    const bool closed = seed % 2 == 1;
    auto soup =
        closed ? sample::tube(30, 30, sample::elbow, inside) : sample::sheet(30, 30, sample::wavy, inside);
    // Any numbering of the triangles must give the same answer.
    std::shuffle(soup.triangles.begin(), soup.triangles.end(), random);
    for (auto& t : soup.triangles) std::rotate(t.begin(), t.begin() + random() % 3, t.end());
    const Region r = sample::region(soup);
    const CrossField field = smoothField(r);
    const auto loops = boundaryLoops(r.mesh);
    for (size_t l = 0; l < loops.size(); ++l)
      EXPECT_EQ(4 * turnsAgainst(r, field, loops[l]), field.loopTurns[l]);
    EXPECT_EQ(std::count(field.loopTurns.begin(), field.loopTurns.end(), 0), closed ? 2 : 0);
  }
}

TEST(SingularityFreeField, isUnitAndTangentialAndSmoothOnAWavySheet) {
  const Region r = sample::region(sample::sheet(30, 30, sample::wavy));
  const CrossField field = smoothField(r);
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
  EXPECT_EQ(field.loopTurns, std::vector<int>{4});
}

TEST(SingularityFreeField, turnsOnceAroundAHoleInThePlane) {
  const Region r = sample::region(sample::sheet(20, 20, sample::flat, [](double s, double t) {
    return std::hypot(s - 0.3, t - 0.3) > 0.15 && std::hypot(s - 0.7, t - 0.6) > 0.2;
  }));
  const CrossField field = smoothField(r);
  EXPECT_EQ(sortedTurns(field), (std::vector<int>{-4, -4, 4}));
  for (const auto& d : field.direction) EXPECT_GT(std::abs(d.dot(field.direction[0])), 1 - 1e-9);
}

TEST(SingularityFreeField, followsTheAxisOfATube) {
  const Region r = sample::region(sample::tube(24, 20, sample::cylinder));
  const CrossField field = smoothField(r);
  EXPECT_EQ(sortedTurns(field), (std::vector<int>{0, 0}));
  for (const auto& d : field.direction) {
    const double along = std::abs(d.z());
    EXPECT_LT(std::min(along, 1 - along), 0.01);
  }
}

TEST(SingularityFreeField, tubeWithAHoleHasTwoEnds) {
  const Region r = sample::region(sample::tube(
      30, 20, sample::elbow, [](double s, double t) { return std::hypot(s - 0.5, t - 0.5) > 0.15; }));
  EXPECT_EQ(sortedTurns(smoothField(r)), (std::vector<int>{-4, 0, 0}));
}

TEST(SingularityFreeField, followsPrincipalCurvatureOfASaddle) {
  // principal directions along the axes at the centre, and by symmetry along both axes' planes
  const Region r = sample::region(sample::sheet(24, 24, [](double s, double t) {
    const double x = s - 0.5, y = t - 0.5;
    return Eigen::Vector3d(x, y, x * x - y * y);
  }));
  const CrossField field = smoothField(r);
  for (const auto f : r.mesh.faces()) {
    if (r.mesh.calc_face_centroid(f).norm() > 0.1) continue;
    const auto& d = field.direction[f.idx()];
    EXPECT_GT(std::max(std::abs(d.x()), std::abs(d.y())), 0.96);
  }
}

TEST(SingularityFreeField, needsABoundaryAndNoHandles) {
  EXPECT_TRUE(admitsNoSingularity(sample::region(sample::sheet(4, 4, sample::flat)).mesh));
  EXPECT_TRUE(admitsNoSingularity(sample::region(sample::tube(6, 4, sample::cylinder)).mesh));
  EXPECT_FALSE(admitsNoSingularity(sample::region(sample::sphere(4)).mesh));
  TriangleSoup torus = sample::torus(12, 16);
  EXPECT_FALSE(admitsNoSingularity(sample::region(torus).mesh));
  torus.triangles.pop_back();  // one hole in a surface of genus 1
  EXPECT_FALSE(admitsNoSingularity(sample::region(torus).mesh));
}

TEST(SingularityFreeField, isTheSameForARotatedSurface) {
  const auto soup = sample::sheet(20, 20, sample::wavy);
  auto turned = soup;
  const Eigen::Matrix3d rotation =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  for (auto& p : turned.points) p = 1e3 * (rotation * p) + Eigen::Vector3d(5, 6, 7);
  const auto a = smoothField(sample::region(soup)), b = smoothField(sample::region(turned));
  for (size_t f = 0; f < a.direction.size(); ++f)
    EXPECT_NEAR((rotation * a.direction[f] - b.direction[f]).norm(), 0, 1e-4);
}

}  // namespace
}  // namespace trimquad
