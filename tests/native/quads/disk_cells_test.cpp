// Cells with holes, and the sides that are led through these.

#include "trimquad/quads/disk_cells.h"

#include "quad_checks.h"

using namespace trimquad;
using namespace trimquad::samples;

namespace {

/// A plate from (-1, -1) to (-1 + width, -1 + width) of squares of 0.05 quads, without some.
GridMap plate(int width, const std::function<bool(int, int)>& leaveOut) {
  return planarMap(sheet(
      20 * width, 20 * width, [](int i, int j) { return Eigen::Vector2d(-1 + 0.05 * i, -1 + 0.05 * j); },
      leaveOut));
}

/// Without squares [i, i + n) x [j, j + n).
GridMap plateWithHole(int i0, int j0, int n) {
  return plate(3, [=](int i, int j) { return i >= i0 && i < i0 + n && j >= j0 && j < j0 + n; });
}

/// Whether a point lies on the boundary of a hole of a plate three quads wide.
bool isOnHole(const QuadMesh::Point& point) {
  return point.border && (point.position - Eigen::Vector3d(0.5, 0.5, 0)).cwiseAbs().maxCoeff() < 1.4;
}

std::vector<const QuadMesh::Cell*> cellsOnHole(const QuadMesh& quads) {
  std::vector<const QuadMesh::Cell*> cells;
  for (const auto& cell : quads.cells)
    if (std::any_of(cell.loops[0].begin(), cell.loops[0].end(),
                    [&](QuadPointId id) { return isOnHole(quads.points[id.index]); }))
      cells.push_back(&cell);
  return cells;
}

int withHoles(const QuadMesh& quads) {
  int count = 0;
  for (const auto& cell : quads.cells) count += cell.loops.size() > 1;
  return count;
}

/// The polygons at inner points are those of the map's quarter turns around.
int wrongValences(const QuadMesh& quads) {
  std::vector<int> valence(quads.points.size(), 0);
  for (const auto& polygon : polygonsOf(quads))
    for (const auto id : polygon) ++valence[id.index];
  int wrong = 0;
  for (size_t p = 0; p < valence.size(); ++p)
    wrong += !quads.points[p].border && valence[p] != quads.points[p].quads;
  return wrong;
}

void align(GridMap& map, const std::function<bool(Eigen::Vector3d, Eigen::Vector3d)>& isAligned) {
  for (const auto e : map.mesh.edges()) {
    const auto h = map.mesh.halfedge_handle(e, 0);
    if (isAligned(map.mesh.point(map.mesh.from_vertex_handle(h)),
                  map.mesh.point(map.mesh.to_vertex_handle(h))))
      map.aligned.push_back(e);
  }
}

/// A plane ring whose map shifts by `shift` quads around the hole, between radii in quads.
GridMap dislocation(Eigen::Vector2d shift, Eigen::Vector2d offset, double inner, double outer) {
  constexpr int kAround = 48, kAcross = 24;
  MappedSoup mapped;
  const auto place = [&](int i, int j) -> Eigen::Vector2d {
    const double angle = 2 * M_PI * i / kAround, radius = inner + (outer - inner) * j / kAcross;
    return {radius * std::cos(angle), radius * std::sin(angle)};
  };
  for (int j = 0; j <= kAcross; ++j)
    for (int i = 0; i < kAround; ++i) mapped.soup.points.push_back({place(i, j).x(), place(i, j).y(), 0});
  const auto vertex = [&](int i, int j) { return j * kAround + i % kAround; };
  const auto at = [&](int i, int j) -> Eigen::Vector2d {
    return offset + place(i, j) + shift * (double(i) / kAround);
  };
  for (int j = 0; j < kAcross; ++j)
    for (int i = 0; i < kAround; ++i) {
      mapped.add({vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1)},
                 {at(i, j), at(i, j + 1), at(i + 1, j + 1)});
      mapped.add({vertex(i, j), vertex(i + 1, j + 1), vertex(i + 1, j)},
                 {at(i, j), at(i + 1, j + 1), at(i + 1, j)});
    }
  return gridMapOf(mapped);
}

bool isOn(double x, double value) {
  return std::abs(x - value) < 1e-9;
}

}  // namespace

TEST(DiskCells, theNearestSideIsLedThroughAHoleInsideACell) {
  // The hole is nearest to the cell's right side.
  const QuadMesh quads = extractSound(plateWithHole(34, 28, 4));
  EXPECT_EQ(withHoles(quads), 0);
  const auto cells = cellsOnHole(quads);
  ASSERT_EQ(cells.size(), 2u);
  EXPECT_EQ(cells[0]->corner, (FixedVector{0, 0}));
  EXPECT_EQ(cells[1]->corner, (FixedVector{1, 0}));
  for (const auto* cell : cells) {
    EXPECT_FALSE(cell->full);
    EXPECT_TRUE(cell->simple.empty());
  }
  EXPECT_NEAR(cells[0]->area + cells[1]->area, 2 - 0.2 * 0.2, 1e-5);
  // Between the side u = 1 and the near bank of the hole, u = 0.9 from v = 0.4 to v = 0.6.
  EXPECT_NEAR(cells[1]->area, 1 + 0.1 * (1 + 0.2) / 2, 1e-5);
  for (const auto& piece : quads.boundary) {
    if (!isOnHole(quads.points[piece.from.index])) continue;
    const auto& loop = quads.cells[piece.cell.index].loops[0];
    const auto from = std::find(loop.begin(), loop.end(), piece.from);
    ASSERT_NE(from, loop.end());
    EXPECT_EQ(from + 1 == loop.end() ? loop[0] : from[1], piece.to);
  }
}

TEST(DiskCells, aPerforatedPlateWithAHoleInEveryCell) {
  const QuadMesh quads = extractSound(
      plate(5, [](int i, int j) { return i % 20 >= 9 && i % 20 < 11 && j % 20 >= 7 && j % 20 < 9; }));
  EXPECT_EQ(withHoles(quads), 16);  // at the rim, where diagonals end
}

TEST(DiskCells, aHoleWithACornerOnASideOrOnACorner) {
  for (const Eigen::Vector3d& tip : {Eigen::Vector3d(1, 0.5, 0), Eigen::Vector3d(1, 1, 0)}) {
    const TriangleSoup soup{
        {{-1, -1, 0}, {2, -1, 0}, {2, 2, 0}, {-1, 2, 0}, tip, {0.6, 0.7, 0}, {0.6, 0.3, 0}},
        {{0, 1, 6}, {1, 4, 6}, {1, 2, 4}, {2, 5, 4}, {2, 3, 5}, {3, 0, 5}, {0, 6, 5}}};
    const QuadMesh quads = extractSound(planarMap(soup));
    EXPECT_EQ(withHoles(quads), 0);
    for (const auto& cell : quads.cells) EXPECT_TRUE(cell.simple.empty());
  }
}

TEST(DiskCells, holesAlongSides) {
  for (const int j : {28, 36}) extractSound(plateWithHole(36, j, 4));
  // One touches the side u = 1, another lies apart in the same cell.
  extractSound(plate(3, [](int i, int j) {
    return (i >= 36 && i < 40 && j >= 28 && j < 32) || (i >= 24 && i < 26 && j >= 30 && j < 33);
  }));
}

TEST(DiskCells, alignedSidesStay) {
  GridMap map = plateWithHole(34, 28, 4);
  align(map, [](Eigen::Vector3d a, Eigen::Vector3d b) { return isOn(a.x(), 1) && isOn(b.x(), 1); });
  const QuadMesh quads = extractSound(map);
  const auto cells = cellsOnHole(quads);
  ASSERT_EQ(cells.size(), 2u);
  EXPECT_NE(cells[0]->corner, (FixedVector{1, 0}));
  EXPECT_NE(cells[1]->corner, (FixedVector{1, 0}));
}

TEST(DiskCells, aCellWithAlignedSidesOnlyIsCutByDiagonals) {
  GridMap map = plateWithHole(28, 28, 4);
  align(map, [](Eigen::Vector3d a, Eigen::Vector3d b) {
    return (isOn(a.x(), b.x()) && (isOn(a.x(), 0) || isOn(a.x(), 1))) ||
           (isOn(a.y(), b.y()) && (isOn(a.y(), 0) || isOn(a.y(), 1)));
  });
  const QuadMesh quads = extractQuads(map, {}, Progress());
  expectManifold(quads, map);
  EXPECT_EQ(withHoles(quads), 1);
  EXPECT_EQ(wrongValences(quads), 2);
}

TEST(DiskCells, cellsThatReachAroundAHoleToBothSidesOfASide) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  int divided = 0;
  for (const Eigen::Vector2d& shift : {Eigen::Vector2d(1, 0), Eigen::Vector2d(0, -1), Eigen::Vector2d(1, 1)})
    for (int k = 0; k < 40 && !testing::Test::HasFailure(); ++k) {
      const Eigen::Vector2d offset(unit(random), unit(random));
      SCOPED_TRACE("shift " + std::to_string(shift.x()) + ' ' + std::to_string(shift.y()) + ", offset " +
                   std::to_string(offset.x()) + ' ' + std::to_string(offset.y()));
      const QuadMesh quads = extractSound(dislocation(shift, offset, 0.3, 3.3));
      std::set<std::pair<FaceHandle, FixedVector>> places;  // a part keeps that of the whole cell
      for (const auto& cell : quads.cells) divided += !places.insert({cell.chart, cell.corner}).second;
    }
  EXPECT_GT(divided, 20);
}

TEST(DiskCells, aCellThatComesThroughAnInnerPointTwiceIsDivided) {
  const auto map = shiftedPlate(6, {{3, 2, 1, 1, {-1, -1}}}, 0.428331, {0.137578, 0.079842});
  ASSERT_TRUE(map);
  extractSound(*map);
}
