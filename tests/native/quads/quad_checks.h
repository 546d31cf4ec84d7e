#pragma once

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "support/sample_maps.h"
#include "trimquad/quads/extract_quads.h"

namespace trimquad {

/// The polygons that quads.obj lists.
inline std::vector<QuadMesh::Polygon> polygonsOf(const QuadMesh& quads) {
  std::vector<QuadMesh::Polygon> polygons;
  for (const auto& cell : quads.cells)
    for (const auto& p : cell.simple.empty() ? cell.loops : cell.simple) polygons.push_back(p);
  return polygons;
}

inline double mapArea(const GridMap& map) {
  double area = 0;
  for (const auto f : map.mesh.faces()) {
    const auto h = map.mesh.halfedge_handle(f), n = map.mesh.next_halfedge_handle(h);
    const Eigen::Vector2d a = map.scale.toQuads(map.to(h) - map.from(h)),
                          b = map.scale.toQuads(map.to(n) - map.from(h));
    area += 0.5 * (a.x() * b.y() - a.y() * b.x());
  }
  return area;
}

/// The polygons are a manifold like the surface, counted anew from them alone, and the cells have its area.
inline void expectManifold(const QuadMesh& quads, const GridMap& map) {
  std::map<std::pair<int, int>, int> sides;
  std::vector<bool> used(quads.points.size(), false);
  const auto polygons = polygonsOf(quads);
  for (const auto& polygon : polygons) {
    ASSERT_GE(polygon.size(), 3u);
    std::set<QuadPointId> different(polygon.begin(), polygon.end());
    EXPECT_EQ(different.size(), polygon.size()) << "a polygon has a point twice";
    for (size_t k = 0; k < polygon.size(); ++k) {
      used[polygon[k].index] = true;
      EXPECT_EQ(++sides[std::pair(polygon[k].index, polygon[(k + 1) % polygon.size()].index)], 1)
          << "two polygons use a side in the same direction";
    }
  }
  int edges = 0;
  for (const auto& [side, count] : sides)
    edges += side.first < side.second || !sides.count({side.second, side.first});
  const int euler = int(quads.points.size()) - edges + int(polygons.size());
  EXPECT_EQ(euler, eulerCharacteristic(map.mesh));
  EXPECT_EQ(quads.eulerCharacteristic, euler);

  double area = 0;
  for (const auto& cell : quads.cells) {
    area += cell.area;
    EXPECT_GT(cell.area, -1e-5);
  }
  EXPECT_NEAR(area, mapArea(map), 1e-4);
  for (const bool isUsed : used) EXPECT_TRUE(isUsed);
}

/// What every extracted mesh must be: a manifold whose inner points have as many polygons as quads around.
inline void expectSound(const QuadMesh& quads, const GridMap& map) {
  expectManifold(quads, map);
  std::vector<int> valence(quads.points.size(), 0);
  for (const auto& polygon : polygonsOf(quads))
    for (const auto id : polygon) ++valence[id.index];
  for (const auto& cell : quads.cells) {
    if (!cell.full) continue;
    EXPECT_EQ(cell.area, 1);
    ASSERT_EQ(cell.loops.size(), 1u);
    ASSERT_EQ(cell.loops[0].size(), 4u);
    for (const auto id : cell.loops[0]) EXPECT_EQ(quads.points[id.index].kind, QuadMesh::PointKind::Grid);
  }
  for (size_t p = 0; p < quads.points.size(); ++p) {
    if (!quads.points[p].border) {
      EXPECT_EQ(valence[p], quads.points[p].quads);
    }
  }
}

inline QuadMesh extractSound(const GridMap& map, const std::vector<VertexHandle>& corners = {}) {
  const Progress progress;
  QuadMesh quads = extractQuads(map, corners, progress);
  expectSound(quads, map);
  return quads;
}

inline int countKind(const QuadMesh& quads, QuadMesh::PointKind kind, bool border) {
  int count = 0;
  for (const auto& p : quads.points) count += p.kind == kind && p.border == border;
  return count;
}

}  // namespace trimquad
