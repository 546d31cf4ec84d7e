#include "support/tmesh_checks.h"

namespace trimquad {

void shuffleSeamlessCharts(Parametrization& map, std::mt19937& random) {
  for (const auto f : map.mesh.faces()) {
    const Transition t{int(random() % 4),
                       {Quanta(random() % 100000) - 50000, Quanta(random() % 100000) - 50000}};
    for (const auto h : map.mesh.fh_range(f)) map.corner[h.idx()] = t(map.corner[h.idx()]);
  }
}

double areaOf(const Parametrization& map) {
  double area = 0;
  for (const auto f : map.mesh.faces()) {
    const auto h = map.mesh.halfedge_handle(f);
    area += 0.5 *
            double(cross(map.to(h) - map.from(h), map.from(map.mesh.prev_halfedge_handle(h)) - map.from(h)));
  }
  return area;
}

void expectCourse(const Parametrization& map, const TMesh& tmesh, const TMesh::Arc& arc) {
  if (arc.isVirtual) {
    EXPECT_TRUE(arc.legs.empty());
    return;
  }
  ASSERT_FALSE(arc.legs.empty());
  EXPECT_TRUE(arc.legs.front().from == *tmesh[arc.from].place);
  EXPECT_TRUE(arc.legs.back().to == *tmesh[arc.to].place);
  Quanta sum = 0;
  for (std::size_t k = 0; k < arc.legs.size(); ++k) {
    const auto& leg = arc.legs[k];
    if (k > 0) {
      EXPECT_TRUE(arc.legs[k - 1].to == leg.from);
    }
    const FixedVector a = positionInChart(map, leg.side, leg.from),
                      b = positionInChart(map, leg.side, leg.to);
    const FixedVector step = rotated(b - a, 4 - leg.direction);
    EXPECT_LE(std::abs(step.v), 1);  // a crossing is rounded to quanta where it is not exact
    EXPECT_GE(step.u, 0);
    sum += step.u;
    if (leg.alongEdge) {
      EXPECT_TRUE(std::holds_alternative<VertexHandle>(leg.from.element) ||
                  map.mesh.edge_handle(leg.side) == std::get<EdgeHandle>(leg.from.element));
    }
  }
  EXPECT_LE(std::abs(sum - arc.length), Quanta(arc.legs.size()));
}

void expectPartition(const Parametrization& map, const TMesh& tmesh) {
  for (const auto& arc : tmesh.arcs) expectCourse(map, tmesh, arc);
  // Completed rectangles cover the surface: as much, where there is no virtual arc.
  double area = 0;
  bool isComplete = true;
  for (const auto& patch : tmesh.patches) {
    area += double(tmesh.length(patch.sides[0])) * double(tmesh.length(patch.sides[1]));
    isComplete = isComplete && patch.type == 1;
  }
  if (isComplete)
    EXPECT_NEAR(area / areaOf(map), 1, 1e-9);
  else
    EXPECT_GE(area / areaOf(map), 1 - 1e-9);
  // Four arcs around every node inside, but for T-joints; as many as the cone says at singularities.
  std::vector<int> valence(tmesh.nodes.size(), 0);
  for (const auto& arc : tmesh.arcs)
    if (!arc.isVirtual) ++valence[arc.from.index], ++valence[arc.to.index];
  const auto cones = coneQuarters(map);
  for (std::size_t n = 0; n < tmesh.nodes.size(); ++n) {
    const auto& node = tmesh.nodes[n];
    if (node.border) continue;
    const auto* v = std::get_if<VertexHandle>(&node.place->element);
    switch (node.kind) {
      case TMesh::NodeKind::Singular:
        EXPECT_EQ(valence[n], cones[v->idx()]);
        EXPECT_NE(valence[n], 4);
        break;
      case TMesh::NodeKind::Feature:
      case TMesh::NodeKind::Regular:
        EXPECT_EQ(valence[n], 4);
        break;
      default:
        EXPECT_EQ(node.kind, TMesh::NodeKind::TJunction);
        EXPECT_EQ(valence[n], 3);
    }
  }
  for (const auto v : map.mesh.vertices())
    if (!map.mesh.is_boundary(v) && cones[v.idx()] != 4) {
      EXPECT_TRUE(std::any_of(tmesh.nodes.begin(), tmesh.nodes.end(), [&](const auto& node) {
        return node.critical && node.place && node.place->element == atVertex(v).element;
      }));
    }
}

TMesh soundPartition(const Parametrization& map) {
  const Progress progress;
  TMesh tmesh = partition(map, progress);
  expectPartition(map, tmesh);
  return tmesh;
}

std::map<int, int> typesOf(const TMesh& tmesh) {
  std::map<int, int> count;
  for (const auto& patch : tmesh.patches) ++count[patch.type];
  return count;
}

}  // namespace trimquad
