#pragma once

#include <vector>

#include "trimquad/mesh/surface_mesh.h"

namespace trimquad {

/// A maximal piece of border without a corner inside. Halfedges follow each other; on the surface's boundary
/// they are the inner ones, so that the surface lies to the left.
struct BorderChain {
  std::vector<HalfedgeHandle> halfedges;
};

/// Chosen edges of a mesh (where regions end, or features) cut into chains at the corners. A corner is a
/// vertex in which not exactly two of them meet, or in which they turn by more than `cornerAngle` (radians)
/// measured over one to four edges on both sides; a closed chain without any gets one at its smallest vertex.
/// Each chosen edge is in one chain; chains are in the order of their smallest first halfedge.
class BorderGraph {
 public:
  /// \param border  by edge
  BorderGraph(const SurfaceMesh& mesh, std::vector<bool> border, double cornerAngle);

  const std::vector<BorderChain>& chains() const { return chains_; }
  bool isBorder(EdgeHandle e) const { return border_[e.idx()]; }
  bool isCorner(VertexHandle v) const { return corner_[v.idx()]; }

 private:
  std::vector<bool> border_, corner_;
  std::vector<BorderChain> chains_;
};

/// By edge: whether it is on the boundary or between triangles of different labels (by triangle).
std::vector<bool> bordersBetween(const SurfaceMesh& mesh, const std::vector<int>& label);

/// By triangle: the smallest triangle that it reaches without crossing a wall (by edge). Walls that enclose
/// nothing separate nothing.
std::vector<int> partsBetween(const SurfaceMesh& mesh, const std::vector<bool>& wall);

}  // namespace trimquad
