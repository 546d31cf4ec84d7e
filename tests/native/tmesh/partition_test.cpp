#include "support/tmesh_checks.h"

using namespace trimquad;
using namespace trimquad::samples;

namespace {

/// A grid of n x n cells of the given extent, turned by `angle` and moved off the lattice.
GridMap square(
    int n, double angle, const std::function<bool(int, int)>& leaveOut = [](int, int) { return false; }) {
  return planarMap(sheet(
                       n, n,
                       [&](int i, int j) -> Eigen::Vector2d {
                         return Eigen::Rotation2Dd(angle) * Eigen::Vector2d(i - 0.5 * n, j - 0.5 * n);
                       },
                       leaveOut),
                   30);
}

void alignBoundary(Parametrization& map) {
  for (const auto e : map.mesh.edges())
    if (map.mesh.is_boundary(e)) map.aligned.push_back(e);
}

}  // namespace

TEST(Partition, aConvexSheetIsFourPatchesAroundARegularNode) {
  const TMesh tmesh = soundPartition(square(6, 0.3));
  EXPECT_EQ(typesOf(tmesh), (std::map<int, int>{{11, 4}}));
  EXPECT_EQ(tmesh.nodes.front().kind, TMesh::NodeKind::Regular);
  EXPECT_EQ(tmesh.redSegments.size(), 4u);
}

TEST(Partition, aSheetAlongTheAxesHasCornersToo) {
  const TMesh tmesh = soundPartition(square(6, 0));
  EXPECT_EQ(typesOf(tmesh), (std::map<int, int>{{11, 4}}));
}

TEST(Partition, anAlignedRectangleIsOnePatch) {
  GridMap map = square(5, 0);
  alignBoundary(map);
  const TMesh tmesh = soundPartition(map);
  EXPECT_EQ(typesOf(tmesh), (std::map<int, int>{{1, 1}}));
  EXPECT_EQ(tmesh.nodes.size(), 4u);
}

TEST(Partition, aSingleTriangleGetsANodeInside) {
  TriangleSoup soup;
  soup.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  soup.triangles = {{0, 1, 2}};
  const TMesh tmesh = soundPartition(planarMap(soup, 30));
  EXPECT_EQ(tmesh.patches.size(), 4u);
  soup.points = {{0, 0, 0}, {1, 0.2, 0}, {0.1, 1, 0}};
  EXPECT_EQ(soundPartition(planarMap(soup, 30)).patches.size(), 4u);
}

TEST(Partition, aHoleSendsMotorcyclesFromItsPeaks) {
  const TMesh tmesh =
      soundPartition(square(8, 0.4, [](int i, int j) { return i > 2 && i < 5 && j > 2 && j < 5; }));
  EXPECT_EQ(tmesh.patches.size(), 4u);
  const TMesh straight =
      soundPartition(square(8, 0, [](int i, int j) { return i > 2 && i < 5 && j > 2 && j < 5; }));
  EXPECT_EQ(straight.patches.size(), 8u);
}

TEST(Partition, conesAndTubesAndTori) {
  std::mt19937 random(3);
  for (const int quarters : {2, 3, 5, 6}) {
    GridMap map = gridMapOf(cone(quarters, 6, 3), 30);
    shuffleSeamlessCharts(map, random);
    const TMesh tmesh = soundPartition(map);
    EXPECT_EQ(int(tmesh.patches.size()), quarters);
    EXPECT_EQ(typesOf(tmesh), (std::map<int, int>{{11, quarters}}));
    alignBoundary(map);
    EXPECT_EQ(typesOf(soundPartition(map)), (std::map<int, int>{{1, quarters}}));
  }
  for (const bool torus : {true, false}) {
    GridMap map = gridMapOf(wrapped(12, 8, 0.51, 0.62, torus), 30);
    shuffleSeamlessCharts(map, random);
    const TMesh tmesh = soundPartition(map);
    EXPECT_EQ(tmesh.patches.size(), torus ? 1u : 2u);
    if (torus) continue;
    alignBoundary(map);
    const TMesh aligned = soundPartition(map);
    EXPECT_EQ(typesOf(aligned).begin()->first, 1);
  }
}
