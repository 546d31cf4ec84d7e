#pragma once

#include <vector>

#include "trimquad/tmesh/isoline.h"
#include "trimquad/tmesh/tmesh.h"

namespace trimquad {

/// Where the motorcycles of a map start.
struct Seeds {
  struct Node {
    TMesh::NodeKind kind;
    SurfacePoint place;
  };
  /// The first leg of a trace, from a node.
  struct Start {
    NodeId node;
    IsolineLeg leg;
  };
  std::vector<Node> nodes;
  std::vector<Start> motorcycles;
  std::vector<Start> alignedCurves;  ///< once from each end; they lead along aligned edges to the next node
  std::vector<bool> isAligned;       ///< by edge
};

/// Nodes at singularities, feature points, corners, ends and junctions of aligned curves, one on each closed
/// aligned curve without any, and at concave peaks of free boundaries (paper, Definition 4.1). One regular
/// node, next to the parametric centroid, where nothing else would start a motorcycle.
Seeds seeds(const Parametrization& map);

}  // namespace trimquad
