#pragma once

#include <array>
#include <vector>

#include "trimquad/mesh/surface_mesh.h"

namespace trimquad {

/// A triangle that is part of one of a mesh's triangles.
struct TrianglePart {
  FaceHandle whole;
  std::array<VertexHandle, 3> corner;  ///< counter-clockwise
};

/// Replaces triangles of a mesh by parts of them, in place: the cost is that of what is replaced. Everything
/// else keeps its number. The first part of a triangle takes its number, the others come last, in their
/// order. \param parts  those of each triangle one after the other; together they cover it, and have its
/// sides but
///               for those that are cut
/// \param cut  edges that are replaced by pieces, on both sides alike; ascending
void replaceTriangles(SurfaceMesh& mesh, const std::vector<TrianglePart>& parts,
                      const std::vector<EdgeHandle>& cut);

}  // namespace trimquad
