#include "trimquad/tmesh/isoline.h"

#include "quad_checks.h"

using namespace trimquad;
using namespace trimquad::samples;

namespace {

Quanta along(const IsolineLeg& leg, FixedVector x) {
  return x[1 - leg.constantAxis()] * (leg.direction < 2 ? 1 : -1);
}

/// Place in space of the point of the leg's line with the other coordinate `k`, in the leg's triangle.
Eigen::Vector3d place(const GridMap& map, const IsolineLeg& leg, Quanta k) {
  const auto h = leg.side, n = map.mesh.next_halfedge_handle(h);
  const FixedVector x = leg.constantAxis() == 0 ? FixedVector{leg.constant, k} : FixedVector{k, leg.constant};
  const FixedVector a = map.from(h), b = map.from(n), c = map.to(n);
  const double whole = double(cross(b - a, c - a)), wb = double(cross(x - a, c - a)) / whole,
               wc = double(cross(b - a, x - a)) / whole;
  return (1 - wb - wc) * map.mesh.point(map.mesh.from_vertex_handle(h)) +
         wb * map.mesh.point(map.mesh.from_vertex_handle(n)) +
         wc * map.mesh.point(map.mesh.to_vertex_handle(n));
}

/// Where the line from a vertex meets the next grid point; none where it ends on the boundary before.
std::optional<Eigen::Vector3d> nextGridPoint(const GridMap& map, IsolineLeg leg) {
  // The line starts in a grid point, so the next one is one quad further on in every chart.
  Quanta goal = along(leg, map.from(leg.side));
  if (map.mesh.from_vertex_handle(leg.side) != leg.fromVertex) goal = along(leg, map.to(leg.side));
  goal += map.scale.one();
  for (;;) {
    const auto h = leg.side, n = map.mesh.next_halfedge_handle(h);
    const int axis = leg.direction < 2 ? 1 : -1;
    const FixedVector x = leg.constantAxis() == 0 ? FixedVector{leg.constant, goal * axis}
                                                  : FixedVector{goal * axis, leg.constant};
    const FixedVector a = map.from(h), b = map.from(n), c = map.to(n);
    if (orientation(a, b, x) >= 0 && orientation(b, c, x) >= 0 && orientation(c, a, x) >= 0)
      return place(map, leg, goal * axis);
    const auto next = continued(map, leg);
    if (!next) return {};
    // The goal's coordinate in the next chart: by a point of the line that both charts see.
    const auto shared = leg.exit.is_valid() ? leg.exit : HalfedgeHandle();
    if (shared.is_valid()) {
      const FixedVector there = map.transition(shared)(x);
      goal = along(*next, there);
    } else {
      auto corner = leg.side;
      while (map.mesh.from_vertex_handle(corner) != leg.toVertex)
        corner = map.mesh.next_halfedge_handle(corner);
      const Quanta left = goal - along(leg, map.from(corner));
      goal = along(*next, map.from(next->side)) + left;
    }
    leg = *next;
  }
}

}  // namespace

TEST(Isoline, linesFromGridPointsFollowTheSidesOfQuads) {
  std::mt19937 random(11);
  std::vector<GridMap> maps;
  for (const int quarters : {3, 4, 5}) maps.push_back(gridMapOf(cone(quarters, 12, 4)));
  maps.push_back(gridMapOf(wrapped(24, 15, 0.5, 0.6, true)));
  maps.push_back(gridMapOf(wrapped(18, 10, 0.5, 0.6, false)));
  for (auto& map : maps) {
    shuffleCharts(map, random);
    const QuadMesh quads = extractSound(map);
    const auto find = [&](const Eigen::Vector3d& x) {
      int nearest = 0;
      for (size_t p = 0; p < quads.points.size(); ++p)
        if ((quads.points[p].position - x).norm() < (quads.points[nearest].position - x).norm())
          nearest = int(p);
      EXPECT_LT((quads.points[nearest].position - x).norm(), 1e-5);
      return nearest;
    };
    std::set<std::pair<int, int>> sides;
    for (const auto& cell : quads.cells)
      for (const auto& loop : cell.loops)
        for (size_t k = 0; k < loop.size(); ++k)
          sides.insert({loop[k].index, loop[(k + 1) % loop.size()].index});
    int traced = 0;
    const auto cones = coneQuarters(map);
    for (const auto v : map.mesh.vertices()) {
      if (map.mesh.is_boundary(v) || !map.scale.isInteger(map.from(map.mesh.halfedge_handle(v)))) continue;
      int lines = 0;
      for (const auto h : map.mesh.voh_range(v))
        for (int direction = 0; direction < 4; ++direction) {
          const auto leg = isolineFromCorner(map, h, direction);
          if (!leg) continue;
          ++lines;
          const auto x = nextGridPoint(map, *leg);
          if (!x) continue;
          ++traced;
          const std::pair side{find(map.mesh.point(v)), find(*x)};
          EXPECT_TRUE(sides.count(side) && sides.count({side.second, side.first}));
        }
      EXPECT_EQ(lines, cones[v.idx()]);
    }
    EXPECT_GT(traced, 0);
  }
}

TEST(Isoline, aLineThroughRandomTrianglesKeepsItsConstant) {
  // In one chart for the whole plane the constant and the direction stay as they are, whatever the triangles.
  const GridMap map = planarMap(sheet(30, 30, [](int i, int j) {
    return Eigen::Vector2d(0.37 * i + 0.1 * std::sin(3.0 * j), 0.41 * j + 0.1 * std::cos(5.0 * i));
  }));
  int legs = 0;
  for (const auto v : map.mesh.vertices())
    for (const auto h : map.mesh.voh_range(v)) {
      if (map.mesh.is_boundary(h)) continue;
      for (int direction = 0; direction < 4; ++direction) {
        auto leg = isolineFromCorner(map, h, direction);
        const Quanta constant = leg ? leg->constant : 0;
        for (; leg; leg = continued(map, *leg)) {
          ++legs;
          ASSERT_EQ(leg->constant, constant);
          ASSERT_EQ(leg->direction, direction);
        }
      }
    }
  EXPECT_GT(legs, 10000);
}
