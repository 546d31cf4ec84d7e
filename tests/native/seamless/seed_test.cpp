#include "trimquad/seamless/seed.h"
#include "support/rounds.h"

#include <gtest/gtest.h>

#include <random>

#include "support/sample_regions.h"
#include "trimquad/base/error.h"

namespace trimquad {
namespace {

Seed seedOf(const Region& r, double edgeLength) {
  SeedOptions options;
  options.edgeLength = edgeLength;
  return seed(r, options, Progress());
}

/// The map holds what a seamless map promises, and its cones are the field's.
void check(const Region& r, const Seed& s) {
  verify(s.map, false);
  const auto cone = coneQuarters(s.map);
  for (const auto v : r.mesh.vertices())
    if (!r.mesh.is_boundary(v)) {
      EXPECT_EQ(cone[v.idx()], 4 - s.field.index[v.idx()]);
    }
}

std::vector<std::array<int, 3>> ring(int holes) {
  std::vector<std::array<int, 3>> places;
  for (int i = 0; i <= 2 * holes; ++i)
    for (int j = 0; j < 3; ++j)
      if (i % 2 == 0 || j != 1) places.push_back({i, j, 0});
  return places;
}

TEST(Seed, closedSurfacesOfAnyGenus) {
  for (const auto& soup : {sample::sphere(8), sample::boxes({{0, 0, 0}}, 6), sample::torus(16, 32),
                           sample::boxes(ring(1), 4), sample::boxes(ring(2), 4), sample::boxes(ring(3), 4)}) {
    const Region r = sample::region(soup);
    check(r, seedOf(r, 0.2));
  }
}

TEST(Seed, aCubeMapsToSixSquares) {
  const Region r = sample::region(sample::boxes({{0, 0, 0}}, 4));
  const Seed s = seedOf(r, 0.25);
  EXPECT_NEAR(s.map.counters.distortionEnd, 4, 1e-3);
  EXPECT_EQ(std::count(s.field.index.begin(), s.field.index.end(), 1), 8);
}

TEST(Seed, surfacesWithHandlesAndManyBoundaries) {
  auto soup = sample::boxes(ring(2), 5);
  std::mt19937 random(11);
  for (int hole = 0; hole < 6; ++hole)
    soup.triangles.erase(soup.triangles.begin() + random() % soup.triangles.size());
  const Region r = sample::region(sample::withoutUnusedPoints(soup));
  check(r, seedOf(r, 0.3));
}

TEST(Seed, alignedEdgesLieOnGridLines) {
  // The edges of a cube, which bound its sides: every triangle has one at most, but for the corners' ears.
  Region r = sample::region(sample::boxes({{0, 0, 0}}, 6));
  const auto onEdge = [](const Eigen::Vector3d& p) {
    int whole = 0;
    for (int k = 0; k < 3; ++k) whole += p[k] == std::round(p[k]);
    return whole >= 2;
  };
  std::vector<char> taken(r.mesh.n_faces(), 0);
  for (const auto e : r.mesh.edges()) {
    const auto h = r.mesh.halfedge_handle(e, 0), o = r.mesh.halfedge_handle(e, 1);
    const auto a = r.mesh.from_vertex_handle(h), b = r.mesh.to_vertex_handle(h);
    const Eigen::Vector3d d = r.mesh.calc_edge_vector(h);
    if (!onEdge(r.mesh.point(a)) || !onEdge(r.mesh.point(b)) || (d.array() != 0).count() != 1) continue;
    char &f = taken[r.mesh.face_handle(h).idx()], &g = taken[r.mesh.face_handle(o).idx()];
    if (f || g) continue;
    f = g = 1;
    r.aligned.push_back(e);
  }
  ASSERT_GT(r.aligned.size(), 40u);
  const Seed s = seedOf(r, 0.2);
  check(r, s);
  EXPECT_EQ(s.map.aligned.size(), r.aligned.size());
}

TEST(Seed, smoothFieldsIgnoreCurvature) {
  const Region r = sample::region(sample::sphere(8));
  SeedOptions options;
  options.follow = SeedOptions::Follow::Smooth;
  options.edgeLength = 0.2;
  check(r, seed(r, options, Progress()));
}

TEST(Seed, roughRandomSurfacesGetAnExactMapOrAnHonestError) {
  int failed = 0, all = 0;
  for (unsigned number = 0; number < sample::rounds(300); ++number) {
    SCOPED_TRACE(number);
    std::mt19937 random(number);
    std::normal_distribution<double> noise(0, 0.02 * double(number % 5));
    const int n = 2 + int(random() % 4);
    TriangleSoup soup = number % 3 == 0   ? sample::sphere(n)
                        : number % 3 == 1 ? sample::boxes(ring(1 + int(number % 2)), n)
                                          : sample::torus(n + 4, n + 6);
    for (auto& p : soup.points) p += Eigen::Vector3d(noise(random), noise(random), noise(random));
    for (unsigned hole = 0; hole < number % 4; ++hole)
      soup.triangles.erase(soup.triangles.begin() + random() % soup.triangles.size());
    std::optional<Region> r;
    try {
      r = sample::region(sample::withoutUnusedPoints(soup));
    } catch (const Error&) {
      continue;  // two holes that touch in a vertex
    }
    ++all;
    try {
      check(*r, seedOf(*r, 0.1 + 0.1 * double(random() % 5)));
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), Error::Kind::Stage);
      ++failed;
    }
  }
  EXPECT_GT(all, int(sample::rounds(300)) / 2);
  EXPECT_LE(failed, (all + 99) / 100);
}

TEST(Seed, isTheSameFromRunToRun) {
  const Region r = sample::region(sample::boxes(ring(2), 3));
  EXPECT_EQ(seedOf(r, 0.3).map.corner, seedOf(r, 0.3).map.corner);
}

}  // namespace
}  // namespace trimquad
