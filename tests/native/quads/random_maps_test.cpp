// Random flat maps, with coordinates on a coarse lattice so that grid points fall on vertices and edges and
// edges on grid lines, and with holes; checked against a count of the grid points by brute force.

#include <algorithm>

#include "quad_checks.h"
#include "trimquad/base/error.h"

using namespace trimquad;
using namespace trimquad::samples;

namespace {

constexpr int kBits = 20;

/// Integer coordinates in lattice units while the triangulation grows; a quad is `perQuad` units wide.
struct RandomTriangulation {
  std::mt19937& random;
  Quanta perQuad;
  std::vector<FixedVector> points;
  std::vector<std::array<int, 3>> triangles;

  Quanta pick(Quanta low, Quanta high) { return low + Quanta(random() % std::uint64_t(high - low + 1)); }
  int turn(const std::array<int, 3>& t) const {
    return orientation(points[t[0]], points[t[1]], points[t[2]]);
  }

  void start(Quanta size) {
    while (triangles.empty()) {
      points.clear();
      for (int k = 0; k < 3; ++k) points.push_back({pick(-size, size), pick(-size, size)});
      if (turn({0, 1, 2}) > 0) triangles.push_back({0, 1, 2});
    }
  }

  /// A new point strictly inside a random triangle, or strictly inside a random edge.
  void insert() {
    const size_t t = random() % triangles.size();
    const auto [a, b, c] = triangles[t];
    Quanta low[2], high[2];
    for (int axis = 0; axis < 2; ++axis) {
      low[axis] = std::min({points[a][axis], points[b][axis], points[c][axis]});
      high[axis] = std::max({points[a][axis], points[b][axis], points[c][axis]});
    }
    const FixedVector x{pick(low[0], high[0]), pick(low[1], high[1])};
    const int sides[3] = {orientation(points[a], points[b], x), orientation(points[b], points[c], x),
                          orientation(points[c], points[a], x)};
    const int n = int(points.size());
    if (*std::min_element(sides, sides + 3) > 0) {
      points.push_back(x);
      triangles[t] = {a, b, n};
      triangles.push_back({b, c, n});
      triangles.push_back({c, a, n});
      return;
    }
    for (int k = 0; k < 3; ++k)
      if (sides[k] == 0 && sides[(k + 1) % 3] > 0 && sides[(k + 2) % 3] > 0)
        return splitEdge(triangles[t][k], triangles[t][(k + 1) % 3], x);
  }

  void splitEdge(int p, int q, FixedVector x) {
    const int n = int(points.size());
    points.push_back(x);
    const size_t count = triangles.size();
    for (size_t t = 0; t < count; ++t)
      for (int k = 0; k < 3; ++k) {
        const int i = triangles[t][k], j = triangles[t][(k + 1) % 3], apex = triangles[t][(k + 2) % 3];
        if (!((i == p && j == q) || (i == q && j == p))) continue;
        triangles[t] = {i, n, apex};
        triangles.push_back({n, j, apex});
        break;
      }
  }

  /// Attaches a triangle to a random boundary edge; it may overlap others, a map is only locally injective.
  void grow(Quanta size) {
    const auto [a, b, c] = triangles[random() % triangles.size()];
    for (const auto& t : triangles)
      for (int k = 0; k < 3; ++k)
        if (t[k] == b && t[(k + 1) % 3] == a) return;
    points.push_back({pick(-size, size), pick(-size, size)});
    const std::array<int, 3> ear{b, a, int(points.size()) - 1};
    if (turn(ear) > 0)
      triangles.push_back(ear);
    else
      points.pop_back();
  }

  void flip() {
    const size_t t = random() % triangles.size();
    const int k = int(random() % 3);
    const int a = triangles[t][k], b = triangles[t][(k + 1) % 3], c = triangles[t][(k + 2) % 3];
    for (size_t s = 0; s < triangles.size(); ++s)
      for (int m = 0; m < 3; ++m) {
        if (triangles[s][m] != b || triangles[s][(m + 1) % 3] != a) continue;
        const int d = triangles[s][(m + 2) % 3];
        if (c == d || turn({c, a, d}) <= 0 || turn({d, b, c}) <= 0 || joined(c, d)) return;
        triangles[t] = {c, a, d};
        triangles[s] = {d, b, c};
        return;
      }
  }

  bool joined(int p, int q) const {
    for (const auto& t : triangles)
      if (std::count(t.begin(), t.end(), p) && std::count(t.begin(), t.end(), q)) return true;
    return false;
  }

  /// Takes a random triangle out if the rest stays a manifold; true when it does.
  bool pierce() {
    if (triangles.size() < 2) return false;
    const auto before = triangles;
    triangles.erase(triangles.begin() + long(random() % triangles.size()));
    try {
      map();
    } catch (const Error&) {
      triangles = before;
      return false;
    }
    return true;
  }

  GridMap map() const {
    MappedSoup mapped;
    const auto place = [&](int v) -> Eigen::Vector2d {
      return Eigen::Vector2d(double(points[v].u), double(points[v].v)) / double(perQuad);
    };
    std::vector<int> number(points.size(), -1);  // vertices that piercing has left alone are not in the mesh
    for (const auto& t : triangles) {
      for (const int v : t) {
        if (number[v] >= 0) continue;
        number[v] = int(mapped.soup.points.size());
        mapped.soup.points.push_back({place(v).x(), place(v).y(), 0});
      }
      mapped.add({number[t[0]], number[t[1]], number[t[2]]}, {place(t[0]), place(t[1]), place(t[2])});
    }
    return gridMapOf(mapped, kBits);
  }
};

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

/// Cells with holes lie flat here, so their simple polygons must tile them.
void expectTiled(const QuadMesh& quads) {
  for (const auto& cell : quads.cells) {
    double area = 0;
    for (const auto& polygon : cell.simple) {
      double part = 0;
      for (size_t k = 0; k < polygon.size(); ++k) {
        const auto &p = quads.points[polygon[k].index].position,
                   &q = quads.points[polygon[(k + 1) % polygon.size()].index].position;
        part += 0.5 * (p.x() * q.y() - p.y() * q.x());
      }
      EXPECT_GE(part, -1e-4);
      area += part;
    }
    if (!cell.simple.empty()) {
      EXPECT_NEAR(area, cell.area, 1e-4);
    }
  }
}

void checkRandomMap(unsigned seed) {
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  RandomTriangulation t{random, Quanta(1) << (random() % 8), {}, {}};
  const Quanta size = std::max<Quanta>(3, t.perQuad * Quanta(1 + random() % 5));
  t.start(size);
  const int steps = int(random() % 60);
  for (int k = 0; k < steps; ++k) {
    const unsigned what = random() % 10;
    if (what < 5)
      t.insert();
    else if (what < 8)
      t.flip();
    else
      t.grow(size);
  }
  for (int k = int(random() % 6); k > 0; --k) t.pierce();

  GridMap map = t.map();
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
