#pragma once

#include <vector>

#include "trimquad/mesh/surface_mesh.h"

namespace trimquad {

/// The halfedge from `a` to `b`; invalid where no edge joins them.
inline HalfedgeHandle halfedgeBetween(const SurfaceMesh& mesh, VertexHandle a, VertexHandle b) {
  const HalfedgeHandle first = mesh.halfedge_handle(a);
  if (!first.is_valid()) return HalfedgeHandle();
  HalfedgeHandle h = first;
  do {
    if (mesh.to_vertex_handle(h) == b) return h;
    h = mesh.next_halfedge_handle(mesh.opposite_halfedge_handle(h));
  } while (h != first);
  return HalfedgeHandle();
}

/// Moves the vertex that `h` leaves onto the one that it leads to; the triangles of the edge vanish. It must
/// not change the topology. What is gone stays in the mesh, marked as deleted; the vertex has no halfedge any
/// more. As SurfaceMesh::collapse, without its checks.
void collapseEdge(SurfaceMesh& mesh, HalfedgeHandle h);

/// What has another number than before.
struct Renumbered {
  struct Move {
    int from, to;
  };
  std::vector<Move> vertices, edges, faces;
};

/// Takes deleted elements out of the mesh: the last ones take their numbers, all others keep theirs. The cost
/// is that of what is moved, and a look at each element. Of the properties positions alone go with their
/// elements.
Renumbered takeOutDeleted(SurfaceMesh& mesh);

}  // namespace trimquad
