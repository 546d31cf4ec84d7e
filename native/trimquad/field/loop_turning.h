#pragma once

#include <vector>

#include "trimquad/field/transport.h"
#include "trimquad/mesh/surface_mesh.h"

namespace trimquad {

/// Sum of the exterior angles along a boundary loop.
double tangentTurn(const SurfaceMesh& mesh, const std::vector<HalfedgeHandle>& loop);

/// The interior halfedges that a walk along the loop crosses, close to it, with the surface on its left.
template <typename Visit>
void walkBeside(const SurfaceMesh& mesh, const std::vector<HalfedgeHandle>& loop, const Visit& visit) {
  // A boundary halfedge has the surface on its right, so the walk runs against the loop's order.
  for (size_t i = loop.size(); i-- > 0;) {
    const HalfedgeHandle inner = mesh.opposite_halfedge_handle(loop[i]);  // surface on its left
    // Around the vertex that `inner` enters, clockwise from inner's face to the next boundary edge.
    HalfedgeHandle h = mesh.next_halfedge_handle(inner);
    while (!mesh.is_boundary(mesh.opposite_halfedge_handle(h))) {
      visit(h);
      h = mesh.next_halfedge_handle(mesh.opposite_halfedge_handle(h));
    }
  }
}

/// The boundary loops of a genus-0 region and how fields without singularities can differ around them.
///
/// A singularity-free field is settled up to deformation by how often each loop turns against it: full turns,
/// +1 for the outer loop of a plane region, -1 for a hole in it, 0 for either end of a tube. The turns of all
/// loops add up to the Euler characteristic. A generator is a path between two loops: letting the angle of
/// the field, in frames, jump by a full turn across it changes the turns of loops, and of nothing else.
struct LoopTurning {
  std::vector<std::vector<HalfedgeHandle>> loops;  ///< as boundaryLoops
  std::vector<int> turns;                          ///< per loop, of the field with angle 0 and no generator
  /// Per generator (one less than loops): the halfedges that cross its path from its right to its left.
  std::vector<std::vector<HalfedgeHandle>> paths;
  /// effect[generator][loop]: what a jump of one full turn across the generator adds to the loop's turns.
  std::vector<std::vector<int>> effect;
};

LoopTurning loopTurning(const SurfaceMesh& mesh, const Transport& transport);

/// Per generator the number of full turns that give the loops the turns `wanted` (their sum must be right).
std::vector<int> generatorTurns(const LoopTurning& turning, const std::vector<int>& wanted);

}  // namespace trimquad
