#pragma once

#include <vector>

#include "trimquad/mesh/refined_mesh.h"
#include "trimquad/tmesh/tmesh.h"

namespace trimquad {

/// A curve along edges of a mesh, from vertex to vertex; closed where the first is the last.
using EdgePath = std::vector<VertexHandle>;

/// Where the nodes and arcs of a T-mesh lie on a mesh.
struct ArcPaths {
  std::vector<std::optional<VertexHandle>> node;  ///< by node of the T-mesh; none for virtual ones
  std::vector<EdgePath> arc;                      ///< by arc; empty for virtual ones
  std::vector<EdgePath> redSegment;               ///< by red segment
  int crossings = 0;                              ///< vertices that the exact arcs have and the mesh has not
};

/// Puts all real arcs into the mesh: vertices where they cross edges and in their nodes, in exact order, and
/// triangles that do not cross them. Where nothing else is near, arcs run along edges instead, as
/// deformations of the exact ones. No triangle has its corners on one side or one arc. \param surface becomes
/// the map's mesh, refined (in place, as OpenMesh's meshes cannot be moved)
ArcPaths insertArcs(const Parametrization& map, const TMesh& tmesh, RefinedMesh& surface);

}  // namespace trimquad
