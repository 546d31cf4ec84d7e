#pragma once

#include <string>
#include <vector>

#include "trimquad/mesh/surface_mesh.h"

namespace trimquad {

/// What `repair` changed, as counts.
struct RepairReport {
  int unusedVertices = 0;      ///< dropped
  int repeatedCorners = 0;     ///< triangles dropped that named a vertex, or a place, twice
  int duplicateTriangles = 0;  ///< triangles dropped that had the same corners as an earlier one
  int weldedVertices = 0;      ///< vertices merged with one at bitwise the same place, to close cracks
  int splitVertices = 0;       ///< copies made of vertices in which sheets only touch
  int turnedTriangles = 0;     ///< triangles whose orientation was reversed
  int flatTriangles = 0;       ///< triangles without area, resolved by flipping or collapsing an edge
  std::vector<int> triangle;   ///< by triangle of the repaired soup: its number before

  int count() const;  ///< all of them together
  bool changed() const { return count() > 0; }
  /// One line for people: "3 duplicate triangles dropped, 8 vertices welded"; empty if nothing changed.
  std::string summary() const;
};

/// Makes an oriented manifold of `soup`, as far as this needs no guessing: afterwards `buildSurfaceMesh`
/// takes it, every vertex is used and every triangle has an area. Components that are closed face outward,
/// open ones the way in which most of their triangles do. Positions stay bitwise the same, vertices and
/// triangles keep their order.
///
/// Vertices at the same place are merged only along cracks: where exactly two boundary edges lie on each
/// other. Throws Error(Input) with element and position for what has no unique repair: edges with more than
/// two triangles, surfaces with one side only, triangles without area that no flip or collapse resolves,
/// non-finite coordinates, numbers of vertices that do not exist, no triangles.
RepairReport repair(TriangleSoup& soup);

}  // namespace trimquad
