// Random flat maps, with coordinates on a coarse lattice so that grid points fall on vertices and edges and
// edges on grid lines, and with holes; checked against a count of the grid points by brute force.

#include <algorithm>

#include "quad_checks.h"
#include "support/random_triangulation.h"
#include "support/sample_maps.h"

using namespace trimquad;
using namespace trimquad::samples;

namespace {

/// Grid points strictly inside: counted triangle by triangle, vertex by vertex, edge by edge.
int interiorGridPoints(const GridMap& map) {
  const auto& mesh = map.mesh;
  int count = 0;
  for (const auto v : mesh.vertices())
    if (!mesh.is_isolated(v) && !mesh.is_boundary(v))
      count += map.scale.isInteger(map.from(mesh.halfedge_handle(v)));
  const auto each = [&](std::initializer_list<FixedVector> corners, const auto& test) {
    Quanta low[2], high[2];
    for (int axis = 0; axis < 2; ++axis) {
      const auto less = [axis](FixedVector a, FixedVector b) { return a[axis] < b[axis]; };
      low[axis] = std::min(corners, less)[axis] >> map.scale.bits;
      high[axis] = (std::max(corners, less)[axis] >> map.scale.bits) + 1;
    }
    for (Quanta u = low[0]; u <= high[0]; ++u)
      for (Quanta v = low[1]; v <= high[1]; ++v)
        count += test(FixedVector{u * map.scale.one(), v * map.scale.one()});
  };
  for (const auto e : mesh.edges()) {
    if (mesh.is_boundary(e)) continue;
    const FixedVector a = map.from(mesh.halfedge_handle(e, 0)), b = map.to(mesh.halfedge_handle(e, 0));
    each({a, b}, [&](FixedVector x) { return orientation(a, b, x) == 0 && dot(a - x, b - x) < 0; });
  }
  for (const auto f : mesh.faces()) {
    const auto h = mesh.halfedge_handle(f), n = mesh.next_halfedge_handle(h);
    const FixedVector a = map.from(h), b = map.from(n), c = map.to(n);
    each({a, b, c}, [&](FixedVector x) {
      return orientation(a, b, x) > 0 && orientation(b, c, x) > 0 && orientation(c, a, x) > 0;
    });
  }
  return count;
}

double planarArea(const QuadMesh& quads, const QuadMesh::Polygon& polygon) {
  double area = 0;
  for (size_t k = 0; k < polygon.size(); ++k) {
    const auto &p = quads.points[polygon[k].index].position,
               &q = quads.points[polygon[(k + 1) % polygon.size()].index].position;
    area += 0.5 * (p.x() * q.y() - p.y() * q.x());
  }
  return area;
}

/// Cells with holes lie flat here, so their simple polygons must tile them.
void expectTiled(const QuadMesh& quads) {
  for (const auto& cell : quads.cells) {
    double area = 0;
    for (const auto& polygon : cell.simple) {
      const double part = planarArea(quads, polygon);
      EXPECT_GE(part, -1e-4);
      area += part;
    }
    if (!cell.simple.empty()) {
      EXPECT_NEAR(area, cell.area, 1e-4);
    }
  }
}

bool touch(const ShiftedHole& a, const ShiftedHole& b) {
  return a.column <= b.column + b.columns && b.column <= a.column + a.columns && a.row <= b.row + b.rows &&
         b.row <= a.row + a.rows;
}

void checkRandomMap(unsigned seed) {
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  GridMap map = randomTriangulation(random, 60, 6);
  shuffleCharts(map, random);
  std::vector<VertexHandle> corners;
  for (const auto v : map.mesh.vertices())
    if (!map.mesh.is_isolated(v) && map.mesh.is_boundary(v) && random() % 4 == 0) corners.push_back(v);
  const QuadMesh quads = extractSound(map, corners);
  EXPECT_EQ(countKind(quads, QuadMesh::PointKind::Grid, false), interiorGridPoints(map));
  for (const auto& p : quads.points) EXPECT_TRUE(p.border || p.quads == 4);
  expectTiled(quads);
}

}  // namespace

TEST(RandomMaps, everyQuadMeshIsSound) {
  for (unsigned seed = 0; seed < 4000 && !testing::Test::HasFailure(); ++seed) checkRandomMap(seed);
}

TEST(RandomMaps, aTurnedDiskIsSound) {
  for (unsigned seed = 0; seed < 60 && !testing::Test::HasFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    const double angle = 2 * M_PI * unit(random), radius = 0.2 + 6 * unit(random);
    const Eigen::Vector2d center(unit(random), unit(random));
    const Eigen::Rotation2Dd turned(angle);
    const int n = 3 + int(random() % 20);
    const auto soup = sheet(n, n, [&](int i, int j) -> Eigen::Vector2d {
      const Eigen::Vector2d square(2.0 * i / n - 1, 2.0 * j / n - 1);
      const Eigen::Vector2d disk =
          square.isZero() ? square : Eigen::Vector2d(square * square.cwiseAbs().maxCoeff() / square.norm());
      return center + radius * (turned * Eigen::Vector2d(0.2 * square + 0.8 * disk));
    });
    GridMap map = planarMap(soup, 30);
    shuffleCharts(map, random);
    const QuadMesh quads = extractSound(map);
    EXPECT_EQ(countKind(quads, QuadMesh::PointKind::Grid, false), interiorGridPoints(map));
    if (radius > 2) {
      EXPECT_NEAR(statistics(quads).angleDeviation.max, 0, 1e-4);
    }
  }
}

TEST(RandomMaps, aPerforatedPlateIsSound) {
  int led = 0;
  for (unsigned seed = 0; seed < 150 && !testing::Test::HasFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    const int n = 12 + int(random() % 30);
    const double step = (2 + 8 * unit(random)) / n;  // in quads
    std::vector<bool> hole(size_t(n * n), false);
    for (int tries = int(random() % 90); tries > 0; --tries) {
      const int w = 1 + int(random() % 3), h = 1 + int(random() % 3),
                i = 1 + int(random() % unsigned(n - w - 1)), j = 1 + int(random() % unsigned(n - h - 1));
      bool free = true;  // and apart from the others
      for (int x = i - 1; x <= i + w; ++x)
        for (int y = j - 1; y <= j + h; ++y) free = free && !hole[size_t(y * n + x)];
      for (int x = i; x < i + w; ++x)
        for (int y = j; y < j + h; ++y)
          if (free) hole[size_t(y * n + x)] = true;
    }
    const Eigen::Rotation2Dd turned(random() % 3 ? 2 * M_PI * unit(random) : 0);
    const Eigen::Vector2d start =
        random() % 3 ? Eigen::Vector2d(unit(random), unit(random)) : Eigen::Vector2d(0, 0);
    GridMap map = planarMap(sheet(
                                n, n,
                                [&](int i, int j) -> Eigen::Vector2d {
                                  return start + turned * Eigen::Vector2d(step * i, step * j);
                                },
                                [&](int i, int j) { return hole[size_t(j * n + i)]; }),
                            30);
    shuffleCharts(map, random);
    std::vector<VertexHandle> corners;  // all, so that outlines are exact
    for (const auto v : map.mesh.vertices())
      if (!map.mesh.is_isolated(v) && map.mesh.is_boundary(v)) corners.push_back(v);
    const QuadMesh quads = extractSound(map, corners);
    expectTiled(quads);
    double area = 0;
    for (const auto& cell : quads.cells) {
      const double polygon = cell.simple.empty() ? planarArea(quads, cell.loops[0]) : cell.area;
      EXPECT_GT(polygon, 0);
      area += polygon;
      led += !cell.full && cell.area > 1;
    }
    EXPECT_NEAR(area, mapArea(map), 1e-4);
  }
  EXPECT_GT(led, 50) << "sides that go through holes";
}

/// Around such a hole a cell can meet itself, even in a point that is its corner twice.
TEST(RandomMaps, aPlateWithShiftedHolesIsSound) {
  int mapped = 0;
  for (unsigned seed = 0; seed < 700 && !testing::Test::HasFailure(); ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    const int n = 5 + int(random() % 12);
    std::vector<ShiftedHole> holes;
    for (int tries = 1 + int(random() % 4); tries > 0; --tries) {
      const int w = 1 + int(random() % 2), h = 1 + int(random() % 2);
      const ShiftedHole hole{1 + int(random() % unsigned(n - w - 1)),
                             1 + int(random() % unsigned(n - h - 1)),
                             w,
                             h,
                             {int(random() % 3) - 1, int(random() % 3) - 1}};
      if (std::none_of(holes.begin(), holes.end(), [&](const auto& other) { return touch(hole, other); }))
        holes.push_back(hole);
    }
    const double step = 1.2 * unit(random), turn = random() % 3 ? 2 * M_PI * unit(random) : 0;
    const Eigen::Vector2d offset(unit(random), unit(random));
    auto map = shiftedPlate(n, holes, step, offset, turn);
    if (!map) continue;
    ++mapped;
    SCOPED_TRACE("seed " + std::to_string(seed));
    shuffleCharts(*map, random);
    extractSound(*map);
  }
  EXPECT_GT(mapped, 300);
}
