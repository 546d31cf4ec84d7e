#pragma once

#include <vector>

#include "trimquad/mesh/surface_mesh.h"

namespace trimquad {

/// A maximal piece of border without a corner inside. Halfedges follow each other; on the surface's boundary
/// they are the inner ones, so that the surface lies to the left.
struct BorderChain {
  std::vector<HalfedgeHandle> halfedges;
};

/// Where regions end: boundary edges and the edges between triangles of different labels, cut into chains at
/// the corners. A corner is a vertex in which not exactly two border edges meet, or in which the border turns
/// by more than `cornerAngle` (radians) measured over one to four edges on both sides; a closed chain without
/// any gets one at its smallest vertex. Each border edge is in one chain; chains are in the order of their
/// smallest first halfedge.
class BorderGraph {
 public:
  /// `label` is by triangle.
  BorderGraph(const SurfaceMesh& mesh, const std::vector<int>& label, double cornerAngle);

  const std::vector<BorderChain>& chains() const { return chains_; }
  bool isBorder(EdgeHandle e) const { return border_[e.idx()]; }
  bool isCorner(VertexHandle v) const { return corner_[v.idx()]; }

 private:
  std::vector<bool> border_, corner_;
  std::vector<BorderChain> chains_;
};

/// By triangle: the smallest triangle that it reaches without crossing an edge where the normals turn by more
/// than `angle` (radians). Sharp edges that enclose nothing separate nothing.
std::vector<int> partsBetweenSharpEdges(const SurfaceMesh& mesh, double angle);

}  // namespace trimquad
