#include "trimquad/quads/extract_quads.h"

#include "quad_checks.h"
#include "trimquad/base/error.h"

using namespace trimquad;
using namespace trimquad::samples;
using Kind = QuadMesh::PointKind;

namespace {

GridMap rectangle(double u0, double v0, double u1, double v1, int columns, int rows) {
  return planarMap(sheet(columns, rows, [=](int i, int j) {
    return Eigen::Vector2d(u0 + (u1 - u0) * i / columns, v0 + (v1 - v0) * j / rows);
  }));
}

std::vector<VertexHandle> verticesAt(const GridMap& map, std::vector<Eigen::Vector2d> places) {
  std::vector<VertexHandle> found;
  for (const auto v : map.mesh.vertices())
    for (const auto& p : places)
      if ((map.mesh.point(v).head<2>() - p).norm() < 1e-9) found.push_back(v);
  return found;
}

}  // namespace

TEST(ExtractQuads, aRectangleOffTheGridHasTrimmedCellsAround) {
  const GridMap map = rectangle(0.25, 0.5, 4.75, 3.5, 7, 5);
  const auto corners = verticesAt(map, {{0.25, 0.5}, {4.75, 0.5}, {0.25, 3.5}, {4.75, 3.5}});
  const QuadMesh quads = extractSound(map, corners);
  const QuadStatistics s = statistics(quads);
  EXPECT_EQ(s.quads, 3 * 2);
  EXPECT_EQ(s.trimmed, 5 * 4 - 6);
  EXPECT_EQ(s.irregularVertices, 0);
  EXPECT_EQ(countKind(quads, Kind::Grid, false), 4 * 3);
  EXPECT_EQ(countKind(quads, Kind::Crossing, true), 2 * 4 + 2 * 3);
  EXPECT_EQ(countKind(quads, Kind::Corner, true), 4);
  EXPECT_NEAR(s.edgeLength.mean, 1, 1e-6);
  EXPECT_NEAR(s.angleDeviation.max, 0, 1e-6);
}

TEST(ExtractQuads, sidesOfATubeAreDoubledWhereItIsTwoQuadsAround) {
  const auto doubled = [](int around) {
    return doubledSide(extractQuads(gridMapOf(wrapped(12, 8, around / 12.0, 0.5, false)), {}, Progress()))
        .has_value();
  };
  EXPECT_TRUE(doubled(2));
  EXPECT_FALSE(doubled(3));
}

TEST(ExtractQuads, aRectangleOnTheGridIsAllQuads) {
  const QuadMesh quads = extractSound(rectangle(0, 0, 3, 2, 7, 3));
  EXPECT_EQ(statistics(quads).quads, 6);
  EXPECT_EQ(statistics(quads).trimmed, 0);
  EXPECT_EQ(quads.points.size(), 12u);
}

TEST(ExtractQuads, gridPointsOnVerticesAndEdgesCountOnce) {
  const QuadMesh quads = extractSound(rectangle(-0.5, -0.5, 3.5, 3.5, 8, 8));  // on vertices and diagonals
  EXPECT_EQ(countKind(quads, Kind::Grid, false), 16);
  const QuadMesh onEdges = extractSound(rectangle(-0.5, -1, 3.5, 1, 3, 2));
  EXPECT_EQ(countKind(onEdges, Kind::Grid, false), 4);
  EXPECT_EQ(countKind(onEdges, Kind::Grid, true), 8);
}

TEST(ExtractQuads, twoHugeTrianglesHoldTheWholeGrid) {
  const QuadMesh quads = extractSound(rectangle(0.5, 0.5, 60.5, 40.5, 1, 1));
  EXPECT_EQ(statistics(quads).quads, 59 * 39);
}

TEST(ExtractQuads, aGridLineAlongTheBoundaryIsTheBoundary) {
  const QuadMesh quads = extractSound(rectangle(0, 0.5, 3, 2.5, 5, 5));
  EXPECT_EQ(statistics(quads).quads, 3);
  EXPECT_EQ(statistics(quads).trimmed, 6);
}

TEST(ExtractQuads, aCornerCutOffWithoutGridPointIsACell) {
  // One triangle whose tip sticks out over the line u = 1.
  TriangleSoup soup{{{0.2, 0.2, 0}, {1.2, 0.5, 0}, {0.2, 0.8, 0}}, {{0, 1, 2}}};
  const QuadMesh quads = extractSound(planarMap(soup), {VertexHandle(0), VertexHandle(1), VertexHandle(2)});
  EXPECT_EQ(statistics(quads).trimmed, 2);
  EXPECT_EQ(quads.points.size(), 5u);
  // Without marked corners each cell still gets the third point it needs.
  EXPECT_EQ(extractSound(planarMap(soup)).points.size(), 4u);
}

TEST(ExtractQuads, aSurfaceInsideOneCellIsOneCell) {
  TriangleSoup soup{{{0.2, 0.2, 0}, {0.7, 0.2, 0}, {0.7, 0.7, 0}, {0.2, 0.7, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  const QuadMesh quads = extractSound(planarMap(soup));
  ASSERT_EQ(quads.cells.size(), 1u);
  EXPECT_FALSE(quads.cells[0].full);
  EXPECT_EQ(quads.cells[0].corner, (FixedVector{0, 0}));
  EXPECT_NEAR(quads.cells[0].area, 0.25, 1e-6);
}

TEST(ExtractQuads, diagonalsToAHoleEndOnTheBoundaryWhereTheyCan) {
  // Beside a hole, the cell has two corners inside the surface and the others on the boundary.
  const auto soup = sheet(
      40, 20, [](int i, int j) { return Eigen::Vector2d(0.1 * i - 0.05, 0.1 * j + 0.25); },
      [](int i, int j) { return i == 15 && j == 2; });
  const QuadMesh quads = extractSound(planarMap(soup));
  std::vector<int> valence(quads.points.size(), 0);
  for (const auto& polygon : polygonsOf(quads))
    for (const auto id : polygon) ++valence[id.index];
  for (size_t p = 0; p < valence.size(); ++p)
    if (!quads.points[p].border) {
      EXPECT_EQ(valence[p], quads.points[p].quads);
    }
}

TEST(ExtractQuads, severalHolesInsideACellAreCutIntoSimplePolygons) {
  const auto soup = sheet(
      40, 40, [](int i, int j) { return Eigen::Vector2d(-0.5 + 0.05 * i, -0.5 + 0.05 * j); },
      [](int i, int j) { return (i == 15 || i == 20 || i == 25) && (j == 14 || j == 19 || j == 24); });
  const QuadMesh quads = extractSound(planarMap(soup));
  int withHoles = 0;
  for (const auto& cell : quads.cells)
    if (cell.loops.size() > 1) {
      ++withHoles;
      EXPECT_EQ(cell.loops.size(), 9u);  // a side goes through one of the nine holes
      EXPECT_GE(cell.simple.size(), 2u);
    }
  EXPECT_EQ(withHoles, 1);
}

TEST(ExtractQuads, anAnnulusInsideACellHasTwoLoops) {
  const auto soup = sheet(
      5, 5, [](int i, int j) { return Eigen::Vector2d(0.1 + 0.1 * i, 0.1 + 0.1 * j); },
      [](int i, int j) { return i > 0 && i < 4 && j > 0 && j < 4; });
  const QuadMesh quads = extractSound(planarMap(soup));
  ASSERT_EQ(quads.cells.size(), 1u);
  EXPECT_EQ(quads.cells[0].loops.size(), 2u);
  EXPECT_EQ(quads.cells[0].loops[0].size(), 20u);
}

TEST(ExtractQuads, twoPiecesOfOneCellAreTwoCells) {
  // A slit from below reaches into the cell (0, 0) and splits its lower part, but not the cell row above.
  const auto soup = sheet(
      15, 10, [](int i, int j) { return Eigen::Vector2d(-1 + 0.2 * i, 0.1 + 0.2 * j); },
      [](int i, int j) { return i == 7 && j < 6; });
  const QuadMesh quads = extractSound(planarMap(soup));
  int pieces = 0;
  for (const auto& cell : quads.cells) pieces += cell.corner == FixedVector{0, 0};
  EXPECT_EQ(pieces, 2);
}

TEST(ExtractQuads, sliverTrianglesAreNoTrouble) {
  const auto soup = sheet(3, 400, [](int i, int j) {
    return Eigen::Vector2d(-0.5 + 1.3 * i + 1e-6 * (j % 7), 0.01 * j + (i % 2 ? 3e-3 : 0));
  });
  EXPECT_GT(statistics(extractSound(planarMap(soup, 30))).quads, 0);
}

TEST(ExtractQuads, aSingularVertexHasAsManyQuadsAsQuarters) {
  for (const int quarters : {2, 3, 5, 6}) {
    const QuadMesh quads = extractSound(gridMapOf(cone(quarters, 9, 2.6)));
    EXPECT_EQ(statistics(quads).irregularVertices, 1);
    EXPECT_EQ(statistics(quads).quads, quarters * 4);
    EXPECT_EQ(statistics(quads).trimmed, quarters * 5);
  }
}

TEST(ExtractQuads, chartsDoNotMatter) {
  std::mt19937 random(7);
  for (const int quarters : {3, 4, 5}) {
    GridMap map = gridMapOf(cone(quarters, 9, 2.6));
    const std::string before = writeQuadsObj(extractSound(map));
    const QuadStatistics s = statistics(extractSound(map));
    shuffleCharts(map, random);
    const QuadStatistics t = statistics(extractSound(map));
    EXPECT_EQ(s.quads, t.quads);
    EXPECT_EQ(s.trimmed, t.trimmed);
    EXPECT_NEAR(s.edgeLength.mean, t.edgeLength.mean, 1e-9);
    EXPECT_EQ(before, writeQuadsObj(extractSound(gridMapOf(cone(quarters, 9, 2.6))))) << "not deterministic";
  }
}

TEST(ExtractQuads, aTorusIsRegularEverywhere) {
  std::mt19937 random(3);
  for (const double offset : {0.0, 0.3}) {
    GridMap map = gridMapOf(wrapped(24, 15, 0.5, 0.6, true, {offset, 2 * offset}));
    for (int repeat = 0; repeat < 2; ++repeat) {
      const QuadMesh quads = extractSound(map);
      EXPECT_EQ(statistics(quads).quads, 12 * 9);
      EXPECT_EQ(statistics(quads).trimmed, 0);
      EXPECT_EQ(statistics(quads).irregularVertices, 0);
      shuffleCharts(map, random);
    }
  }
}

TEST(ExtractQuads, aTubeClosesOverItsSeam) {
  const QuadMesh quads = extractSound(gridMapOf(wrapped(18, 7, 0.5, 0.6, false, {0.2, 0.3})));
  EXPECT_EQ(statistics(quads).quads, 9 * 3);
  EXPECT_EQ(statistics(quads).trimmed, 9 * 2);
  EXPECT_EQ(quads.eulerCharacteristic, 0);
}

TEST(ExtractQuads, aHoleAroundASingularityInsideACell) {
  // The charts' fixed point is the middle of a cell, so the cell has as many sides as the hole has quarters
  // around.
  for (const int quarters : {3, 5}) {
    const QuadMesh quads = extractSound(gridMapOf(cone(quarters, 12, 2.4, 1, {0.5, 0.5})));
    int trimmed = 0, corners = 0;
    for (const auto& cell : quads.cells) {
      EXPECT_EQ(cell.loops.size(), 1u);
      if (std::none_of(cell.loops[0].begin(), cell.loops[0].end(), [&](QuadPointId id) {
            const auto& p = quads.points[id.index];
            return p.border && p.position.norm() < 1;
          }))
        continue;
      ++trimmed;
      for (const auto id : cell.loops[0]) corners += !quads.points[id.index].border;
    }
    EXPECT_EQ(trimmed, 2);  // a side is led through the hole
    EXPECT_EQ(corners, quarters + 4);
  }
}

TEST(ExtractQuads, aTubeUnderAQuadWideIsRefused) {
  const GridMap map = gridMapOf(wrapped(5, 7, 0.2, 0.6, false, {0.2, 0.3}));
  const Progress progress;
  try {
    extractQuads(map, {}, progress);
    FAIL() << "accepted";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), Error::Kind::Coarse);
    EXPECT_NE(std::string(e.what()).find("shorter edge length"), std::string::npos);
  }
}

TEST(ExtractQuads, alignedEdgesBecomeFeatureEdges) {
  GridMap map = rectangle(-2.5, -1.5, 2.5, 1.5, 20, 12);
  for (const auto e : map.mesh.edges()) {
    const auto h = map.mesh.halfedge_handle(e, 0);
    if (map.mesh.point(map.mesh.from_vertex_handle(h)).x() == 1 &&
        map.mesh.point(map.mesh.to_vertex_handle(h)).x() == 1)
      map.aligned.push_back(e);
  }
  const QuadMesh quads = extractSound(map);
  EXPECT_EQ(quads.featureEdges.size(), 4u);  // two whole ones, two that end on the boundary
  EXPECT_NE(writeQuadsObj(quads).find("g feature\nl "), std::string::npos);
}

TEST(ExtractQuads, aMapOffTheGridIsRefused) {
  GridMap map = gridMapOf(cone(3, 4, 2, 0, {0.25, 0.25}));
  const Progress progress;
  EXPECT_THROW(extractQuads(map, {}, progress), Error);
}

TEST(ExtractQuads, cancelling) {
  Progress progress;
  progress.cancel();
  EXPECT_THROW(extractQuads(rectangle(0, 0, 3, 2, 7, 3), {}, progress), Error);
}
