#pragma once

#include <optional>

#include "trimquad/mesh/parametrization.h"

namespace trimquad {

/// A straight piece of an iso-line u = const or v = const: through one triangle, or along one edge. The
/// numbers hold in the chart of the triangle of `side`. Lines are axis-parallel, so everything about them is
/// exact: the constant is a fixed-point number in every chart, and a leg crosses the perpendicular line at k
/// in the point (constant, k).
struct IsolineLeg {
  HalfedgeHandle side;  ///< of the triangle; the edge itself where the leg runs along one
  int direction = 0;    ///< quarter turns from +u, 0..3
  Quanta constant = 0;  ///< of the coordinate that does not change: v for directions 0 and 2, u for 1 and 3
  bool alongEdge = false;
  VertexHandle fromVertex, toVertex;  ///< valid where the leg starts or ends at a vertex
  HalfedgeHandle entry, exit;         ///< sides of the triangle, valid where it starts or ends inside one

  int constantAxis() const { return direction % 2 == 0 ? 1 : 0; }
};

/// The leg that leaves the corner of `h` (at the vertex that h leaves) in `direction` of the chart of h's
/// triangle: where the direction points strictly into the triangle or along `h`, or along the triangle's
/// other side at that corner if that is a boundary edge. So around a vertex every axis direction belongs to
/// exactly one corner.
std::optional<IsolineLeg> isolineFromCorner(const Parametrization& map, HalfedgeHandle h, int direction);

/// The leg that leaves the point `x` strictly inside triangle `f`.
IsolineLeg isolineFromInside(const Parametrization& map, FaceHandle f, FixedVector x, int direction);

/// The leg that enters the triangle of `h` through the inside of `h`, where the line must pass.
IsolineLeg isolineFromSide(const Parametrization& map, HalfedgeHandle h, int direction, Quanta constant);

/// The iso-lines that leave a vertex, counter-clockwise; as many as quarter turns around an interior vertex.
/// At a boundary vertex all axis directions of its closed sector, from the edge that has the surface on its
/// left on.
std::vector<IsolineLeg> isolinesFromVertex(const Parametrization& map, VertexHandle v);

/// The next leg, straight on; none on the boundary (also at a boundary vertex) and at singular vertices.
std::optional<IsolineLeg> continued(const Parametrization& map, const IsolineLeg& leg);

}  // namespace trimquad
