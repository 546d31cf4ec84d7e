#include "trimquad/tmesh/isoline.h"

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

bool sameDirection(FixedVector a, FixedVector axis) {
  return cross(a, axis) == 0 && dot(a, axis) > 0;
}

/// The line of `leg` in the chart on the other side of its triangle's side `h`.
IsolineLeg acrossSide(const Parametrization& map, const IsolineLeg& leg, HalfedgeHandle h) {
  const Transition t = map.transition(h);
  const FixedVector onLine =
      leg.constantAxis() == 0 ? FixedVector{leg.constant, 0} : FixedVector{0, leg.constant};
  IsolineLeg there;
  there.direction = (leg.direction + t.rotation) & 3;
  there.constant = t(onLine)[there.constantAxis()];
  return there;
}

/// The leg that goes straight on from an interior vertex; `corner` leaves it, in the chart of `direction`.
std::optional<IsolineLeg> throughVertex(const Parametrization& map, HalfedgeHandle corner, int direction) {
  std::optional<IsolineLeg> onward;
  int quarters = 0;
  HalfedgeHandle h = corner;
  do {
    // Every axis direction is in one corner, so they count the quarter turns around the vertex.
    for (int axis = 0; axis < 4; ++axis) {
      const auto leg = isolineFromCorner(map, h, axis);
      if (!leg) continue;
      ++quarters;
      if (axis == direction) onward = leg;
    }
    const HalfedgeHandle back = map.mesh.prev_halfedge_handle(h);
    direction = (direction + map.transition(back).rotation) & 3;
    h = map.mesh.opposite_halfedge_handle(back);
  } while (h != corner);
  if (quarters != 4) return {};
  TRIMQUAD_ASSERT(onward);
  return onward;
}

}  // namespace

std::optional<IsolineLeg> isolineFromCorner(const Parametrization& map, HalfedgeHandle h, int direction) {
  const auto& mesh = map.mesh;
  const FixedVector axis = rotated({1, 0}, direction);
  const HalfedgeHandle back = mesh.prev_halfedge_handle(h);
  const FixedVector right = map.to(h) - map.from(h), left = map.from(back) - map.from(h);
  IsolineLeg leg;
  leg.side = h;
  leg.direction = direction;
  leg.constant = map.from(h)[leg.constantAxis()];
  leg.fromVertex = mesh.from_vertex_handle(h);
  if (sameDirection(right, axis)) {
    leg.alongEdge = true;
    leg.toVertex = mesh.to_vertex_handle(h);
    return leg;
  }
  if (sameDirection(left, axis)) {
    if (!mesh.is_boundary(mesh.edge_handle(back))) return {};
    leg.side = back;
    leg.alongEdge = true;
    leg.toVertex = mesh.from_vertex_handle(back);
    return leg;
  }
  if (!strictlyInsideSector(right, left, axis)) return {};
  leg.exit = mesh.next_halfedge_handle(h);
  return leg;
}

IsolineLeg isolineFromInside(const Parametrization& map, FaceHandle f, FixedVector x, int direction) {
  const auto& mesh = map.mesh;
  const FixedVector axis = rotated({1, 0}, direction);
  IsolineLeg leg;
  leg.side = mesh.halfedge_handle(f);
  leg.direction = direction;
  leg.constant = x[leg.constantAxis()];
  for (const auto h : mesh.fh_range(f)) {
    const int from = sign(cross(axis, map.from(h) - x)), to = sign(cross(axis, map.to(h) - x));
    if (from < 0 && to > 0) leg.exit = h;
    if (from == 0 && dot(axis, map.from(h) - x) > 0) leg.toVertex = mesh.from_vertex_handle(h);
  }
  TRIMQUAD_ASSERT(leg.exit.is_valid() != leg.toVertex.is_valid());
  return leg;
}

std::vector<IsolineLeg> isolinesFromVertex(const Parametrization& map, VertexHandle v) {
  const auto& mesh = map.mesh;
  HalfedgeHandle first = mesh.halfedge_handle(v);
  // A boundary vertex's halfedge is the boundary's; the surface begins behind the one before it on the
  // boundary.
  if (mesh.is_boundary(v)) first = mesh.opposite_halfedge_handle(mesh.prev_halfedge_handle(first));
  std::vector<IsolineLeg> around;
  HalfedgeHandle h = first;
  do {
    // Counter-clockwise within the corner: from the quadrant of its first side on.
    const FixedVector side = map.to(h) - map.from(h);
    int base = 0;
    while (dot(side, rotated({1, 0}, base)) <= 0 || cross(side, rotated({1, 0}, base)) < 0) ++base;
    for (int k = 0; k < 4; ++k)
      if (const auto leg = isolineFromCorner(map, h, (base + k) & 3)) around.push_back(*leg);
    h = mesh.opposite_halfedge_handle(mesh.prev_halfedge_handle(h));
  } while (h != first && !mesh.is_boundary(h));
  return around;
}

IsolineLeg isolineFromSide(const Parametrization& map, HalfedgeHandle h, int direction, Quanta constant) {
  const auto& mesh = map.mesh;
  const HalfedgeHandle next = mesh.next_halfedge_handle(h);
  IsolineLeg leg;
  leg.side = leg.entry = h;
  leg.direction = direction;
  leg.constant = constant;
  const auto beside = [&](FixedVector x) {
    const Quanta distance = x[leg.constantAxis()] - constant;
    return (distance > 0) - (distance < 0);
  };
  const int from = beside(map.from(h)), apex = beside(map.to(next));
  TRIMQUAD_ASSERT(from * beside(map.to(h)) < 0);
  if (apex == 0)
    leg.toVertex = mesh.to_vertex_handle(next);
  else
    leg.exit = apex == from ? next : mesh.prev_halfedge_handle(h);
  return leg;
}

std::optional<IsolineLeg> continued(const Parametrization& map, const IsolineLeg& leg) {
  const auto& mesh = map.mesh;
  if (leg.exit.is_valid()) {
    const HalfedgeHandle other = mesh.opposite_halfedge_handle(leg.exit);
    if (mesh.is_boundary(other)) return {};
    const IsolineLeg there = acrossSide(map, leg, leg.exit);
    return isolineFromSide(map, other, there.direction, there.constant);
  }
  if (mesh.is_boundary(leg.toVertex)) return {};
  HalfedgeHandle corner = leg.side;
  while (mesh.from_vertex_handle(corner) != leg.toVertex) corner = mesh.next_halfedge_handle(corner);
  return throughVertex(map, corner, leg.direction);
}

}  // namespace trimquad
