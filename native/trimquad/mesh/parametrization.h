#pragma once

#include <vector>

#include "trimquad/base/fixed.h"
#include "trimquad/mesh/surface_mesh.h"

namespace trimquad {

/// A piecewise linear, locally injective map of a mesh into charts of the plane, exact: coordinates are fixed-point
/// numbers in units of quads, the two images of an edge differ by a quarter-turn rotation and a translation.
struct Parametrization {
  SurfaceMesh mesh;
  FixedScale scale;
  /// By halfedge index: image of the vertex that the halfedge leaves, in the chart of the halfedge's face.
  /// Unused for boundary halfedges.
  std::vector<FixedVector> corner;
  std::vector<EdgeHandle> aligned;            ///< edges that lie on grid lines
  std::vector<VertexHandle> featurePoints;    ///< vertices that lie on grid points

  FixedVector from(HalfedgeHandle h) const { return corner[h.idx()]; }
  FixedVector to(HalfedgeHandle h) const { return corner[mesh.next_halfedge_handle(h).idx()]; }

  /// Chart change from the face of `h` to the face of its opposite; both must exist.
  Transition transition(HalfedgeHandle h) const;
};

/// Throws Error(Stage) naming the first element where the map is not valid: a triangle without positive area, an edge
/// that is not seamless, a singular or feature vertex off the grid or a translation that is no integer (`integer`).
void verify(const Parametrization& map, bool integer);

/// Quarter turns around each interior vertex, 4 where it is regular; 0 for boundary vertices. By vertex index. Exact.
std::vector<int> coneQuarters(const Parametrization& map);

}  // namespace trimquad
