#include "trimquad/field/cross_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "support/sample_regions.h"
#include "trimquad/base/error.h"
#include "trimquad/field/curvature_guidance.h"

namespace trimquad {
namespace {

CrossField fieldOf(const Region& r, double reach = 4) {
  return crossField(r, curvatureGuidance(r, Progress()), reach, Progress());
}

std::map<int, int> counts(const CrossField& field) {
  std::map<int, int> result;
  for (const int index : field.index)
    if (index != 0) ++result[index];
  return result;
}

int total(const CrossField& field) {
  return std::accumulate(field.index.begin(), field.index.end(), 0) +
         std::accumulate(field.loopTurns.begin(), field.loopTurns.end(), 0);
}

/// A ring of boxes: genus 1. Two rings side by side: genus 2.
std::vector<std::array<int, 3>> ring(int holes) {
  std::vector<std::array<int, 3>> places;
  for (int i = 0; i <= 2 * holes; ++i)
    for (int j = 0; j < 3; ++j)
      if (i % 2 == 0 || j != 1) places.push_back({i, j, 0});
  return places;
}

TEST(CrossField, aCubeHasItsEightCorners) {
  const Region r = sample::region(sample::boxes({{0, 0, 0}}, 8));
  const CrossField field = fieldOf(r);
  EXPECT_EQ(counts(field), (std::map<int, int>{{1, 8}}));
  for (const auto v : r.mesh.vertices())
    if (field.index[v.idx()] != 0) {
      const Eigen::Vector3d p = r.mesh.point(v);
      EXPECT_LT((p - p.array().round().matrix()).norm(), 0.3);
    }
}

TEST(CrossField, aSphereHasEightSingularities) {
  EXPECT_EQ(counts(fieldOf(sample::region(sample::sphere(12)))), (std::map<int, int>{{1, 8}}));
}

TEST(CrossField, aTorusHasNone) {
  EXPECT_EQ(counts(fieldOf(sample::region(sample::torus(24, 48)))), (std::map<int, int>{}));
}

TEST(CrossField, aFlatSheetWithHolesHasNone) {
  const Region r = sample::region(sample::sheet(20, 20, sample::flat, [](double s, double t) {
    return std::hypot(s - 0.3, t - 0.3) > 0.15 && std::hypot(s - 0.7, t - 0.6) > 0.2;
  }));
  const CrossField field = fieldOf(r);
  EXPECT_EQ(counts(field), (std::map<int, int>{}));
  auto turns = field.loopTurns;
  std::sort(turns.begin(), turns.end());
  EXPECT_EQ(turns, (std::vector<int>{-4, -4, 4}));
}

TEST(CrossField, indicesAndTurnsAddUpToTheEulerCharacteristic) {
  for (int holes = 1; holes <= 3; ++holes) {
    auto soup = sample::boxes(ring(holes), 3);
    EXPECT_EQ(total(fieldOf(sample::region(soup))), 4 * (2 - 2 * holes));
    soup.triangles.erase(soup.triangles.begin() + 5);
    soup.triangles.pop_back();
    EXPECT_EQ(total(fieldOf(sample::region(sample::withoutUnusedPoints(soup)))), 4 * (-2 * holes));
  }
}

TEST(CrossField, aSmoothFieldHasNoMoreSingularitiesThanOneThatFollowsNoise) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, 0.01);
  auto soup = sample::sphere(10);
  for (auto& p : soup.points) p += Eigen::Vector3d(noise(random), noise(random), noise(random));
  const Region r = sample::region(soup);
  const auto size = [&](double reach) {
    int sum = 0;
    for (const auto& [index, count] : counts(fieldOf(r, reach))) sum += count;
    return sum;
  };
  EXPECT_EQ(size(0), 8);
  EXPECT_GE(size(100), 8);
}

TEST(CrossField, isParallelToAlignedEdges) {
  Region r = sample::region(sample::sheet(
      16, 16, sample::flat, [](double s, double t) { return std::hypot(s - 0.5, t - 0.5) < 0.45; }));
  // Triangles in the corners of the staircase have two boundary edges: these stay free.
  for (const auto e : r.mesh.edges()) {
    if (!r.mesh.is_boundary(e)) continue;
    const auto h = r.mesh.halfedge_handle(e, r.mesh.is_boundary(r.mesh.halfedge_handle(e, 0)) ? 1 : 0);
    int sides = 0;
    for (const auto side : r.mesh.fh_range(r.mesh.face_handle(h)))
      sides += r.mesh.is_boundary(r.mesh.edge_handle(side));
    if (sides == 1) r.aligned.push_back(e);
  }
  ASSERT_GT(r.aligned.size(), 20u);
  const CrossField field = fieldOf(r);
  for (const auto e : r.aligned) {
    const auto h = r.mesh.halfedge_handle(e, r.mesh.is_boundary(r.mesh.halfedge_handle(e, 0)) ? 1 : 0);
    const Eigen::Vector3d along = r.mesh.calc_edge_vector(h).normalized();
    const double dot = std::abs(along.dot(field.direction[r.mesh.face_handle(h).idx()]));
    EXPECT_LT(std::min(dot, 1 - dot), 1e-9);
  }
}

TEST(CrossField, twoAlignedEdgesOfOneTriangleAreRefused) {
  Region r = sample::region(sample::sheet(1, 1, sample::flat));
  for (const auto e : r.mesh.edges())
    if (r.mesh.is_boundary(e)) r.aligned.push_back(e);
  EXPECT_THROW(fieldOf(r), Error);
}

TEST(CrossField, givesUpAnAlignedEdgeThatMeetsOthersTooSharply) {
  // A fan of 12 triangles around the middle: a straight line through it, and a branch 30 degrees off.
  TriangleSoup soup;
  soup.points.emplace_back(0, 0, 0);
  for (int ring = 1; ring <= 3; ++ring)
    for (int k = 0; k < 12; ++k)
      soup.points.emplace_back(ring * std::cos(k * M_PI / 6), ring * std::sin(k * M_PI / 6), 0);
  const auto at = [](int ring, int k) { return 1 + 12 * (ring - 1) + k % 12; };
  for (int k = 0; k < 12; ++k) {
    soup.triangles.push_back({0, at(1, k), at(1, k + 1)});
    for (int ring = 1; ring < 3; ++ring) {
      soup.triangles.push_back({at(ring, k), at(ring + 1, k), at(ring + 1, k + 1)});
      soup.triangles.push_back({at(ring, k), at(ring + 1, k + 1), at(ring, k + 1)});
    }
  }
  Region r = sample::region(soup);
  const auto edge = [&](int a, int b) {
    return r.mesh.edge_handle(r.mesh.find_halfedge(VertexHandle(a), VertexHandle(b)));
  };
  // The second ring of the branch keeps clear of the line, so that no triangle has two aligned edges.
  r.aligned = {edge(0, at(1, 0)), edge(0, at(1, 6)), edge(0, at(1, 2)), edge(at(1, 2), at(2, 2))};
  std::sort(r.aligned.begin(), r.aligned.end());
  // 60 degrees are a quarter turn, and all edges are followed; 30 degrees are none.
  EXPECT_EQ(fieldOf(r).aligned, r.aligned);
  FieldGuidance none{std::vector<Eigen::Vector3d>(r.mesh.n_faces(), Eigen::Vector3d::UnitX()),
                     std::vector<double>(r.mesh.n_faces(), 0.0)};
  for (auto& p : soup.points)
    if (p.head<2>().norm() > 0) {
      const double angle = std::atan2(p.y(), p.x()), radius = p.norm();
      const double narrow =
          angle > 0 ? (angle < M_PI / 3 + 0.01 ? angle / 3 : M_PI / 9 + (angle - M_PI / 3) * 4 / 3) : angle;
      p = {radius * std::cos(narrow), radius * std::sin(narrow), 0};
    }
  Region sharp = sample::region(soup);
  sharp.aligned = r.aligned;
  const auto followed = crossField(sharp, none, 0, Progress()).aligned;
  auto expected = r.aligned;
  std::erase(expected, edge(0, at(1, 2)));
  EXPECT_EQ(followed, expected);
}

TEST(CrossField, followsGivenDirections) {
  const Region r = sample::region(sample::sheet(20, 20, sample::flat));
  FieldGuidance guidance;
  const Eigen::Vector3d wish(std::cos(0.3), std::sin(0.3), 0);
  guidance.direction.assign(r.mesh.n_faces(), wish);
  guidance.weight.assign(r.mesh.n_faces(), 1.0);
  for (const auto& d : crossField(r, guidance, 40, Progress()).direction) {
    const double dot = std::abs(d.dot(wish));
    EXPECT_LT(std::min(dot, 1 - dot), 1e-6);
  }
}

TEST(CrossField, countsDoNotChangeWithPlaceScaleOrNumbering) {
  std::mt19937 random(3);
  for (const auto& soup :
       {sample::boxes(ring(2), 4), sample::sphere(9), sample::boxes({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, 5)}) {
    const auto expected = counts(fieldOf(sample::region(soup)));
    for (const double scale : {1e-3, 1.0, 1e3}) {
      auto other = soup;
      const Eigen::Matrix3d rotation =
          Eigen::AngleAxisd(0.7 + scale, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
      for (auto& p : other.points) p = scale * (rotation * p + Eigen::Vector3d(5, 6, 7));
      std::shuffle(other.triangles.begin(), other.triangles.end(), random);
      for (auto& t : other.triangles) std::rotate(t.begin(), t.begin() + random() % 3, t.end());
      EXPECT_EQ(counts(fieldOf(sample::region(other))), expected);
    }
  }
}

}  // namespace
}  // namespace trimquad
