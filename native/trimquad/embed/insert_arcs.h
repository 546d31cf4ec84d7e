#pragma once

#include <vector>

#include "trimquad/mesh/refined_mesh.h"
#include "trimquad/tmesh/tmesh.h"

namespace trimquad {

/// A curve along edges of a mesh, from vertex to vertex; closed where the first is the last.
using EdgePath = std::vector<VertexHandle>;

/// A mapped surface cut along the arcs of its T-mesh.
struct CutSurface {
  RefinedMesh surface;
  std::vector<std::optional<VertexHandle>> node;  ///< by node of the T-mesh; none for virtual ones
  std::vector<EdgePath> arc;                      ///< by arc; empty for virtual ones
  std::vector<EdgePath> redSegment;               ///< by red segment
};

/// Puts all real arcs into the mesh: vertices where they cross edges and in their nodes, in exact order, and
/// triangles that do not cross them. No triangle has its corners on one side or one arc.
CutSurface insertArcs(const Parametrization& map, const TMesh& tmesh);

}  // namespace trimquad
