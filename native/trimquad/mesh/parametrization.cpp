#include "trimquad/mesh/parametrization.h"

#include <string>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

/// Rotation in quarter turns that takes `a` to `b`, or -1.
int quarterTurn(FixedVector a, FixedVector b) {
  for (int r = 0; r < 4; ++r)
    if (rotated(a, r) == b) return r;
  return -1;
}

/// Which quadrant a direction points into: 0 for u > 0, v >= 0, then counter-clockwise.
int quadrant(FixedVector d) {
  if (d.u > 0 && d.v >= 0) return 0;
  if (d.u <= 0 && d.v > 0) return 1;
  if (d.u < 0 && d.v <= 0) return 2;
  return 3;
}

}  // namespace

Transition Parametrization::transition(HalfedgeHandle h) const {
  const HalfedgeHandle o = mesh.opposite_halfedge_handle(h);
  const FixedVector p = from(h), q = to(h), q2 = from(o), p2 = to(o);
  const int r = quarterTurn(q - p, q2 - p2);
  if (r < 0)
    throw stageError("seamless", "the map is not seamless", "edge " + std::to_string(h.idx() / 2),
                     mesh.point(mesh.from_vertex_handle(h)));
  return {r, p2 - rotated(p, r)};
}

std::vector<int> coneQuarters(const Parametrization& map) {
  // Unroll the fan of each vertex: the total turn of its first edge is a whole number of quarter turns. Count quadrant
  // changes of the direction from one edge to the next in each corner's own chart, which never turn by 180 degrees or
  // more, and carry the direction over by the exact transition.
  const auto& mesh = map.mesh;
  std::vector<int> cone(mesh.n_vertices(), 0);
  for (const auto v : mesh.vertices()) {
    if (mesh.is_boundary(v)) continue;
    int quarters = 0, rotation = 0;
    const HalfedgeHandle start = mesh.halfedge_handle(v);
    HalfedgeHandle h = start;
    const FixedVector first = map.to(h) - map.from(h);
    FixedVector direction = first;
    do {
      const HalfedgeHandle back = mesh.prev_halfedge_handle(h);  // enters v, in the same face
      const FixedVector next = rotated(map.from(back) - map.from(h), rotation);
      int step = (quadrant(next) - quadrant(direction)) & 3;
      // A corner under 180 degrees changes the quadrant by 0, 1 or 2; by 3 never, for that would be over 180.
      TRIMQUAD_ASSERT(step != 3);
      quarters += step;
      const HalfedgeHandle following = mesh.opposite_halfedge_handle(back);
      const int turn = map.transition(back).rotation;
      rotation = (rotation - turn) & 3;
      direction = next;
      h = following;
    } while (h != start);
    TRIMQUAD_ASSERT(((quadrant(direction) - quadrant(first)) & 3) == (quarters & 3));
    cone[v.idx()] = quarters;
  }
  return cone;
}

void verify(const Parametrization& map, bool integer) {
  const auto& mesh = map.mesh;
  const std::string stage = integer ? "optimize" : "seamless";
  const auto fail = [&](const std::string& what, const std::string& where, VertexHandle v) {
    throw stageError(stage, what, where, mesh.point(v));
  };
  for (const auto f : mesh.faces()) {
    const auto h = mesh.halfedge_handle(f);
    const auto n = mesh.next_halfedge_handle(h);
    if (orientation(map.from(h), map.from(n), map.to(n)) <= 0)
      fail("the map turns a triangle over", "triangle " + std::to_string(f.idx()), mesh.from_vertex_handle(h));
  }
  for (const auto e : mesh.edges()) {
    if (mesh.is_boundary(e)) continue;
    const Transition t = map.transition(mesh.halfedge_handle(e, 0));
    if (integer && !map.scale.isInteger(t.translation))
      fail("a seam of the grid map is shifted by a fraction of a quad", "edge " + std::to_string(e.idx()),
           mesh.from_vertex_handle(mesh.halfedge_handle(e, 0)));
  }
  const auto onGrid = [&](VertexHandle v) {
    for (const auto h : mesh.voh_range(v))
      if (!mesh.is_boundary(h) && !map.scale.isInteger(map.from(h))) return false;
    return true;
  };
  const auto cone = coneQuarters(map);
  for (const auto v : mesh.vertices())
    if (integer && !mesh.is_boundary(v) && cone[v.idx()] != 4 && !onGrid(v))
      fail("a singular vertex is off the grid", "vertex " + std::to_string(v.idx()), v);
  if (integer)
    for (const auto v : map.featurePoints)
      if (!onGrid(v)) fail("a feature point is off the grid", "vertex " + std::to_string(v.idx()), v);
  for (const auto e : map.aligned)
    for (int side = 0; side < 2; ++side) {
      const auto h = mesh.halfedge_handle(e, side);
      if (mesh.is_boundary(h)) continue;
      const FixedVector d = map.to(h) - map.from(h);
      if (d.u != 0 && d.v != 0)
        fail("an aligned edge is not parallel to the grid", "edge " + std::to_string(e.idx()), mesh.from_vertex_handle(h));
      if (integer && !map.scale.isInteger(d.u == 0 ? map.from(h).u : map.from(h).v))
        fail("an aligned edge lies between grid lines", "edge " + std::to_string(e.idx()), mesh.from_vertex_handle(h));
    }
}

}  // namespace trimquad
