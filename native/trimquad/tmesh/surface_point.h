#pragma once

#include <compare>
#include <variant>

#include "trimquad/mesh/parametrization.h"

namespace trimquad {

/// A point of a mapped surface, as an iso-line meets it: a vertex, a point inside an edge or inside a
/// triangle. Two values are equal exactly where the points are.
struct SurfacePoint {
  enum class Exact {
    Both,  ///< `position` is the point
    U,     ///< only u is; v is rounded down to a quantum: an iso-line u = const crosses a slanted edge here
    V
  };

  std::variant<VertexHandle, EdgeHandle, FaceHandle> element;
  FixedVector position;  ///< in the chart of the triangle, of `chartSide` of an edge; zero for a vertex
  Exact exact = Exact::Both;

  friend bool operator==(const SurfacePoint&, const SurfacePoint&) = default;
  friend bool operator<(const SurfacePoint& a, const SurfacePoint& b) {
    if (a.element != b.element) return a.element < b.element;
    if (a.exact != b.exact) return a.exact < b.exact;
    return a.position < b.position;
  }
};

/// The halfedge of `e` whose triangle's chart positions on `e` refer to: the first that has a triangle.
HalfedgeHandle chartSide(const SurfaceMesh& mesh, EdgeHandle e);

SurfacePoint atVertex(VertexHandle v);

/// The point `x` of the closed triangle `f`, in its chart.
SurfacePoint pointInTriangle(const Parametrization& map, FaceHandle f, FixedVector x);

/// Where the line x[axis] = c of the chart of h's triangle crosses the edge of `h`, between its ends.
SurfacePoint crossingOfEdge(const Parametrization& map, HalfedgeHandle h, int axis, Quanta c);

/// Position (rounded where it is not exact) of a point of the closed triangle of `h` in its chart.
FixedVector positionInChart(const Parametrization& map, HalfedgeHandle h, const SurfacePoint& x);

/// Order along the edge of `h`, in its direction, of two points inside it; negative if `a` comes first.
/// Exact.
int compareAlong(const Parametrization& map, HalfedgeHandle h, const SurfacePoint& a, const SurfacePoint& b);

/// Place in space, model units.
Eigen::Vector3d placeInSpace(const Parametrization& map, const SurfacePoint& x);

}  // namespace trimquad
