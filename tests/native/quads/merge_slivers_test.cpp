#include "trimquad/quads/merge_slivers.h"

#include <algorithm>

#include "quad_checks.h"
#include "support/random_triangulation.h"
#include "support/sample_maps.h"

using namespace trimquad;
using namespace trimquad::samples;
using Kind = QuadMesh::PointKind;

namespace {

GridMap rectangle(double u0, double v0, double u1, double v1) {
  return planarMap(sheet(
      9, 9, [=](int i, int j) { return Eigen::Vector2d(u0 + (u1 - u0) * i / 9, v0 + (v1 - v0) * j / 9); }));
}

/// A square standing on a corner, sides at |u| + |v| = radius.
GridMap turnedBy45(double radius) {
  return planarMap(sheet(9, 9,
                         [=](int i, int j) {
                           const double a = radius * (i / 9.0 - 0.5), b = radius * (j / 9.0 - 0.5);
                           return Eigen::Vector2d(a - b, a + b);
                         }),
                   40);
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

TEST(VanishingCells, aBoundaryOffAGridLineByLittleComesToLieOnIt) {
  const GridMap map = rectangle(0.5, -1e-7, 4.5, 3.5);
  QuadMesh quads = extract(map);
  ASSERT_EQ(statistics(quads).trimmed, 5 + 2 * 3 + 5);
  EXPECT_EQ(dropVanishingCells(quads), 5);
  expectSound(quads, map);
  EXPECT_EQ(statistics(quads).quads, 3 * 3);
  EXPECT_EQ(statistics(quads).trimmed, 2 * 3 + 5);
  int onLine = 0;
  for (const auto& p : quads.points) onLine += p.kind == Kind::Grid && p.border && p.position.y() < 0;
  EXPECT_EQ(onLine, 4);
}

TEST(VanishingCells, aGridPointBesideTheBoundaryGoesOntoIt) {
  // The boundary cuts off the corner of a cell, 3e-4 wide.
  const GridMap map = turnedBy45(2 + 3e-4);
  QuadMesh quads = extract(map);
  const int inner = countKind(quads, Kind::Grid, false), cells = int(quads.cells.size());
  // Four grid points beside the sides, four at the square's corners with a cell on either side.
  EXPECT_EQ(dropVanishingCells(quads), 12);
  expectSound(quads, map);
  EXPECT_EQ(countKind(quads, Kind::Grid, false), inner - 8);
  EXPECT_EQ(int(quads.cells.size()), cells - 12);
}

TEST(VanishingCells, aCellBetweenAStraightBoundaryAndABentGridLineIsNoPolygon) {
  // The boundary's middle vertex lies beyond the grid line v = 1 in the map, on a line in space.
  MappedSoup mapped;
  mapped.soup.points = {{-1, 0, 0}, {0, -1, 0}, {1, 0, 0}, {0, 0, 0}};
  const Eigen::Vector2d left(0.1, 0.6), bottom(0.5, 0.2), right(0.9, 0.6), top(0.5, 1.2);
  mapped.add({0, 1, 3}, {left, bottom, top});
  mapped.add({1, 2, 3}, {bottom, right, top});
  GridMap map = gridMapOf(mapped);
  QuadMesh quads = extract(map);
  ASSERT_EQ(quads.cells.size(), 2u);
  EXPECT_EQ(dropVanishingCells(quads), 1);
  expectSound(quads, map);
  ASSERT_EQ(quads.cells.size(), 1u);
  // Bent in space as well it stays.
  map.mesh.set_point(VertexHandle(3), {0, 0.01, 0});
  quads = extract(map);
  EXPECT_EQ(dropVanishingCells(quads), 0);
  EXPECT_EQ(quads.cells.size(), 2u);
}

TEST(VanishingCells, largerOnesStay) {
  QuadMesh quads = extract(turnedBy45(2 + 3e-3));
  EXPECT_EQ(dropVanishingCells(quads), 0);
  quads = extract(rectangle(0.5, -1e-5, 4.5, 3.5));
  EXPECT_EQ(dropVanishingCells(quads), 0);
}

TEST(MergeSlivers, randomMapsStayManifoldAndOtherCellsAsTheyWere) {
  int merges = 0;
  for (unsigned seed = 0; seed < 1500 && !testing::Test::HasFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const GridMap map = randomTriangulation(random, 60, 6);
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

TEST(VanishingCells, turnedSquaresAreSoundWhereverTheirSidesAre) {
  int dropped = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    const double off = std::pow(10, -8 * unit(random));
    const Eigen::Rotation2Dd turned(M_PI / 4 * double(random() % 2) +
                                    (random() % 2 ? 1e-7 * unit(random) : 0));
    const double radius = double(1 + random() % 3);
    GridMap map = planarMap(
        sheet(7, 7,
              [&](int i, int j) {
                return Eigen::Vector2d(turned * Eigen::Vector2d((radius + off) * (2 * i / 7.0 - 1),
                                                                (radius + off) * (2 * j / 7.0 - 1)));
              }),
        36);
    shuffleCharts(map, random);
    QuadMesh quads = extract(map);
    dropped += dropVanishingCells(quads);
    expectSound(quads, map);
  }
  EXPECT_GT(dropped, 500);
}

TEST(VanishingCells, randomMapsThatAllButTouchGridLinesAreSound) {
  int dropped = 0;
  for (unsigned seed = 0; seed < 1500 && !testing::Test::HasFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    GridMap map = randomTriangulation(random, 60, 6);
    // Vertices on grid lines come to lie beside them.
    const int shift = 40 - map.scale.bits;
    for (auto& x : map.corner) x = {x.u << shift, x.v << shift};
    map.scale.bits = 40;
    const Quanta most = Quanta(1) << (10 + random() % 20);
    std::vector<FixedVector> offset;
    for (size_t v = 0; v < map.mesh.n_vertices(); ++v)
      offset.push_back({Quanta(random() % (2 * most)) - most, Quanta(random() % (2 * most)) - most});
    for (const auto h : map.mesh.halfedges())
      if (!map.mesh.is_boundary(h)) {
        auto& x = map.corner[h.idx()];
        x = x + offset[map.mesh.from_vertex_handle(h).idx()];
      }
    bool valid = true;
    for (const auto f : map.mesh.faces()) {
      const auto h = map.mesh.halfedge_handle(f), n = map.mesh.next_halfedge_handle(h);
      valid = valid && orientation(map.from(h), map.from(n), map.to(n)) > 0;
    }
    if (!valid) continue;
    QuadMesh quads = extract(map);
    dropped += dropVanishingCells(quads);
    expectSound(quads, map);
    for (const auto& cell : quads.cells)
      if (cell.full) {
        EXPECT_EQ(cell.loops[0].size(), 4u);
      }
  }
  EXPECT_GT(dropped, 500);
}
