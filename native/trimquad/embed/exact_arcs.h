#pragma once

#include <array>
#include <vector>

#include "trimquad/embed/insert_arcs.h"

namespace trimquad {

/// A straight line in a triangle's chart: a side of the triangle, u = constant or v = constant, or a cut.
struct ChartLine {
  enum class Kind { Side, U, V, Cut } kind;
  Quanta number;
  friend auto operator<=>(const ChartLine&, const ChartLine&) = default;
};

/// A piece of an arc inside a triangle.
struct ArcSegment {
  FaceHandle triangle;
  std::array<VertexHandle, 2> end;
  int direction;  ///< quarter turns from +u, before ends were moved
  ChartLine line;
  std::array<bool, 2> moved{};  ///< that end, to a corner of the triangle which no other piece there has
};

/// The arcs of a T-mesh as they meet the edges of a mesh, before they are put into it. New vertices have the
/// numbers after the mesh's own.
struct ExactArcs {
  std::vector<RefinedMesh::Origin> origins;  ///< of new vertices
  std::vector<Eigen::Vector3d> places;       ///< likewise
  std::vector<EdgeHandle> crossed;           ///< edges with new vertices, ascending
  std::vector<int> onEdge;  ///< by edge: where its vertices begin in `along`; -1 if it has none
  std::vector<VertexHandle>
      along;  ///< those on each edge from its halfedge 0's start on, then an invalid one
  std::vector<ArcSegment> segments;
  ArcPaths paths;
};

/// Moves vertices in which arcs cross edges to ends of these edges: such as are next to the end, where no
/// other arc comes through it, so that all cross each other where they did before. (What `snap` would do with
/// most of them) In triangles with a node inside nothing moves.
void snapCrossings(const SurfaceMesh& input, ExactArcs& arcs);

}  // namespace trimquad
