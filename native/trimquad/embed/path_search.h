#pragma once

#include <vector>

#include "trimquad/embed/insert_arcs.h"

namespace trimquad {

/// Which vertices and edges of a mesh the arcs of a T-mesh run through.
struct Occupied {
  std::vector<bool> vertex, edge;  ///< by index

  void grow(const SurfaceMesh& mesh) {
    vertex.resize(mesh.n_vertices(), false);
    edge.resize(mesh.n_edges(), false);
  }
};

/// A corner of a patch: the two halfedges of its loop that meet there, the patch to their left.
struct PatchCorner {
  HalfedgeHandle in, out;
};

/// The shortest way (in space) through the inside of a patch from one of its corners to another. Where no
/// edges lead, it goes through edges and triangles, which are split. As the patch is a disk, the way is the
/// only one up to deformations.
EdgePath connectCorners(const SurfaceMesh& input, RefinedMesh& refined, Occupied& occupied, PatchCorner from,
                        PatchCorner to, int& splits);

}  // namespace trimquad
