#include "support/random_triangulation.h"

#include <algorithm>
#include <array>
#include <vector>

#include "support/sample_maps.h"
#include "trimquad/base/error.h"

namespace trimquad::samples {
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

}  // namespace

GridMap randomTriangulation(std::mt19937& random, unsigned mostSteps, unsigned mostHoles) {
  RandomTriangulation t{random, Quanta(1) << (random() % 8), {}, {}};
  const Quanta size = std::max<Quanta>(3, t.perQuad * Quanta(1 + random() % 5));
  t.start(size);
  const int steps = int(random() % mostSteps);
  for (int k = 0; k < steps; ++k) {
    const unsigned what = random() % 10;
    if (what < 5)
      t.insert();
    else if (what < 8)
      t.flip();
    else
      t.grow(size);
  }
  for (int k = int(random() % mostHoles); k > 0; --k) t.pierce();
  return t.map();
}

}  // namespace trimquad::samples
