#pragma once

#include <array>
#include <vector>

#include "trimquad/embed/embedded_tmesh.h"

namespace trimquad {

/// A patch of an embedded T-mesh as a triangulated disk of its own: a vertex that its loop passes twice is
/// two corners of the disk.
struct PatchDisk {
  std::vector<FaceHandle> faces;
  std::vector<HalfedgeHandle> rim;         ///< the loop, the patch to its left, from the first corner on
  std::vector<std::array<bool, 4>> sides;  ///< by rim vertex: on which closed sides it lies
  /// Vertices of the disk: rim vertex k is where rim[k] starts, inner ones follow.
  std::size_t vertexCount = 0;
  /// By triangle, in the order of `faces`: its vertices, from halfedge_handle(f) on.
  std::vector<std::array<int, 3>> triangles;

  bool isInner(int vertex) const { return std::size_t(vertex) >= rim.size(); }
};

/// Arc edges of the mesh, by index.
std::vector<bool> arcEdges(const EmbeddedTMesh& embedded);

PatchDisk patchDisk(const EmbeddedTMesh& embedded, const std::vector<bool>& arcEdges, PatchId id);

}  // namespace trimquad
