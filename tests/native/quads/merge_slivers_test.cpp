#include "trimquad/quads/merge_slivers.h"

#include <algorithm>

#include "quad_checks.h"
#include "random_triangulation.h"

using namespace trimquad;
using namespace trimquad::samples;

namespace {

GridMap rectangle(double u0, double v0, double u1, double v1) {
  return planarMap(sheet(
      9, 9, [=](int i, int j) { return Eigen::Vector2d(u0 + (u1 - u0) * i / 9, v0 + (v1 - v0) * j / 9); }));
}

QuadMesh extract(const GridMap& map) {
  return extractQuads(map, {}, Progress());
}

std::vector<QuadMesh::Polygon> fullQuads(const QuadMesh& quads) {
  std::vector<QuadMesh::Polygon> full;
  for (const auto& cell : quads.cells)
    if (cell.full) full.push_back(cell.loops[0]);
  std::sort(full.begin(), full.end());
  return full;
}

}  // namespace

TEST(MergeSlivers, aThinRowGoesIntoTheRowBesideIt) {
  // 4 x 3 whole cells, with a row of 0.1 below them only.
  const GridMap map = rectangle(0, -0.1, 4, 3);
  QuadMesh quads = extract(map);
  EXPECT_EQ(statistics(quads).quads, 12);
  EXPECT_EQ(statistics(quads).trimmed, 4);
  EXPECT_EQ(mergeSlivers(quads, 0.2), 4);
  expectManifold(quads, map);
  EXPECT_EQ(quads.mergedSlivers, 4);
  EXPECT_EQ(statistics(quads).quads, 8);
  EXPECT_EQ(statistics(quads).trimmed, 4);
  for (const auto& cell : quads.cells)
    if (!cell.full) {
      EXPECT_NEAR(cell.area, 1.1, 1e-5);
      EXPECT_GT(cell.loops[0].size(), 4u);
    }
}

TEST(MergeSlivers, cellsAtOrOverTheFractionStay) {
  QuadMesh quads = extract(rectangle(0, -0.25, 4, 3));
  EXPECT_EQ(mergeSlivers(quads, 0.25), 0);
  EXPECT_EQ(quads.mergedSlivers, 0);
  EXPECT_EQ(statistics(quads).trimmed, 4);
}

TEST(MergeSlivers, featureEdgesStay) {
  GridMap map = rectangle(0, -0.1, 4, 3);
  QuadMesh quads = extract(map);
  const auto onLine = [&](QuadPointId p) { return std::abs(quads.points[p.index].position.y()) < 1e-6; };
  for (const auto& cell : quads.cells)
    for (size_t k = 0; k < cell.loops[0].size(); ++k) {
      const auto a = cell.loops[0][k], b = cell.loops[0][(k + 1) % cell.loops[0].size()];
      if (onLine(a) && onLine(b) && a < b) quads.featureEdges.push_back({a, b});
    }
  ASSERT_EQ(quads.featureEdges.size(), 4u);
  EXPECT_GT(mergeSlivers(quads, 0.2), 0);
  expectManifold(quads, map);
  EXPECT_EQ(statistics(quads).quads, 12) << "slivers merge with each other along the feature";
}

TEST(MergeSlivers, randomMapsStayManifoldAndOtherCellsAsTheyWere) {
  int merges = 0;
  for (unsigned seed = 0; seed < 1500 && !testing::Test::HasFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    RandomTriangulation t{random, Quanta(1) << (random() % 8), {}, {}};
    const Quanta size = std::max<Quanta>(3, t.perQuad * Quanta(1 + random() % 5));
    t.start(size);
    for (int k = int(random() % 60); k > 0; --k) {
      const unsigned what = random() % 10;
      what < 5 ? t.insert() : what < 8 ? t.flip() : t.grow(size);
    }
    for (int k = int(random() % 6); k > 0; --k) t.pierce();
    const GridMap map = t.map();
    QuadMesh quads = extract(map);
    const QuadMesh before = quads;
    const int merged = mergeSlivers(quads, 0.05 + 0.3 * double(random() % 4));
    merges += merged;
    expectManifold(quads, map);
    EXPECT_EQ(quads.cells.size() + size_t(merged), before.cells.size());
    EXPECT_EQ(quads.points.size(), before.points.size());
    EXPECT_EQ(quads.boundary.size(), before.boundary.size());
    const auto old = fullQuads(before), left = fullQuads(quads);
    EXPECT_TRUE(std::includes(old.begin(), old.end(), left.begin(), left.end()));
    EXPECT_LE(old.size() - left.size(), size_t(merged));
    for (const auto& piece : quads.boundary) {
      const auto& loops = quads.cells[piece.cell.index].loops;
      EXPECT_TRUE(std::any_of(loops.begin(), loops.end(), [&](const auto& loop) {
        for (size_t k = 0; k < loop.size(); ++k)
          if (loop[k] == piece.from && loop[(k + 1) % loop.size()] == piece.to) return true;
        return false;
      }));
    }
  }
  EXPECT_GT(merges, 1000);
}
