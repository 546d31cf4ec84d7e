#include "trimquad/tmesh/surface_point.h"

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

/// Coordinate of the crossing of a -> b with x[axis] = c along the other axis: rounded down; whether exact.
std::pair<Quanta, bool> crossingCoordinate(FixedVector a, FixedVector b, int axis, Quanta c) {
  WideQuanta run = b[axis] - a[axis];
  WideQuanta rise = WideQuanta(b[1 - axis] - a[1 - axis]) * (c - a[axis]);
  if (run < 0) run = -run, rise = -rise;
  WideQuanta quotient = rise / run;
  const WideQuanta rest = rise % run;
  if (rest < 0) --quotient;
  return {a[1 - axis] + Quanta(quotient), rest == 0};
}

Eigen::Vector3d between(const SurfaceMesh& mesh, HalfedgeHandle h, double t) {
  return (1 - t) * mesh.point(mesh.from_vertex_handle(h)) + t * mesh.point(mesh.to_vertex_handle(h));
}

}  // namespace

HalfedgeHandle chartSide(const SurfaceMesh& mesh, EdgeHandle e) {
  const HalfedgeHandle h = mesh.halfedge_handle(e, 0);
  return mesh.is_boundary(h) ? mesh.halfedge_handle(e, 1) : h;
}

SurfacePoint atVertex(VertexHandle v) {
  return {v, {}, SurfacePoint::Exact::Both};
}

SurfacePoint pointInTriangle(const Parametrization& map, FaceHandle f, FixedVector x) {
  for (const auto h : map.mesh.fh_range(f)) {
    if (map.from(h) == x) return atVertex(map.mesh.from_vertex_handle(h));
    if (map.to(h) == x) return atVertex(map.mesh.to_vertex_handle(h));
    if (orientation(map.from(h), map.to(h), x) != 0) continue;
    const EdgeHandle e = map.mesh.edge_handle(h);
    return {e, chartSide(map.mesh, e) == h ? x : map.transition(h)(x), SurfacePoint::Exact::Both};
  }
  return {f, x, SurfacePoint::Exact::Both};
}

SurfacePoint crossingOfEdge(const Parametrization& map, HalfedgeHandle h, int axis, Quanta c) {
  const EdgeHandle e = map.mesh.edge_handle(h);
  const HalfedgeHandle side = chartSide(map.mesh, e);
  if (side != h) {
    const Transition t = map.transition(h);
    c = t(axis == 0 ? FixedVector{c, 0} : FixedVector{0, c})[(axis + t.rotation) & 1];
    axis = (axis + t.rotation) & 1;
  }
  const auto [other, exact] = crossingCoordinate(map.from(side), map.to(side), axis, c);
  const FixedVector x = axis == 0 ? FixedVector{c, other} : FixedVector{other, c};
  if (exact) return {e, x, SurfacePoint::Exact::Both};
  return {e, x, axis == 0 ? SurfacePoint::Exact::U : SurfacePoint::Exact::V};
}

FixedVector positionInChart(const Parametrization& map, HalfedgeHandle h, const SurfacePoint& x) {
  const auto& mesh = map.mesh;
  if (const auto* v = std::get_if<VertexHandle>(&x.element)) {
    for (int k = 0; k < 3; ++k, h = mesh.next_halfedge_handle(h))
      if (mesh.from_vertex_handle(h) == *v) return map.from(h);
    TRIMQUAD_ASSERT(!"the vertex is not of the triangle");
  }
  if (const auto* e = std::get_if<EdgeHandle>(&x.element)) {
    const HalfedgeHandle side = chartSide(mesh, *e);
    return mesh.face_handle(side) == mesh.face_handle(h) ? x.position : map.transition(side)(x.position);
  }
  return x.position;
}

int compareAlong(const Parametrization& map, HalfedgeHandle h, const SurfacePoint& a, const SurfacePoint& b) {
  const HalfedgeHandle side = chartSide(map.mesh, map.mesh.edge_handle(h));
  const FixedVector p = map.from(side), q = map.to(side);
  const auto axisOf = [&](const SurfacePoint& x) {
    if (x.exact == SurfacePoint::Exact::U) return 0;
    if (x.exact == SurfacePoint::Exact::V) return 1;
    return p.u != q.u ? 0 : 1;
  };
  const int i = axisOf(a), j = axisOf(b);
  const int order = compareCrossings(p, q, i, a.position[i], j, b.position[j]);
  return side == h ? order : -order;
}

Eigen::Vector3d placeInSpace(const Parametrization& map, const SurfacePoint& x) {
  const auto& mesh = map.mesh;
  if (const auto* v = std::get_if<VertexHandle>(&x.element)) return mesh.point(*v);
  if (const auto* e = std::get_if<EdgeHandle>(&x.element)) {
    const HalfedgeHandle h = chartSide(mesh, *e);
    const FixedVector a = map.from(h), b = map.to(h);
    int axis = x.exact == SurfacePoint::Exact::V ? 1 : 0;
    if (x.exact == SurfacePoint::Exact::Both && std::abs(b.v - a.v) > std::abs(b.u - a.u)) axis = 1;
    return between(mesh, h, double(x.position[axis] - a[axis]) / double(b[axis] - a[axis]));
  }
  const HalfedgeHandle h = mesh.halfedge_handle(std::get<FaceHandle>(x.element)),
                       n = mesh.next_halfedge_handle(h);
  const FixedVector a = map.from(h), b = map.from(n), c = map.to(n);
  const double whole = double(cross(b - a, c - a)), wb = double(cross(x.position - a, c - a)) / whole,
               wc = double(cross(b - a, x.position - a)) / whole;
  return (1 - wb - wc) * mesh.point(mesh.from_vertex_handle(h)) +
         wb * mesh.point(mesh.from_vertex_handle(n)) + wc * mesh.point(mesh.to_vertex_handle(n));
}

}  // namespace trimquad
