#pragma once

#include <optional>
#include <vector>

#include "trimquad/tmesh/straight_arcs.h"

namespace trimquad {

/// The arcs around one node, counter-clockwise.
struct Spokes {
  struct Spoke {
    HalfArc arc;  ///< leaves the node
    int slot;     ///< quarter turns from the node's first axis direction
    HalfedgeHandle
        corner;  ///< of the triangle in whose chart `direction` holds; leaves the node if that is a vertex
    int direction;
  };
  std::vector<Spoke> spokes;
  int quarters = 0;  ///< around the node; 0 on the boundary, where the order has a begin and an end
};

/// By node.
std::vector<Spokes> spokesAround(const Parametrization& map, const std::vector<Seeds::Node>& nodes,
                                 const std::vector<TMesh::Arc>& arcs);

}  // namespace trimquad
