#pragma once

#include <vector>

#include "trimquad/tmesh/motorcycles.h"

namespace trimquad {

/// Cuts the trails at their nodes: the real arcs of the T-mesh, each with its exact course. Two trails that
/// met head-on are one curve. `border` and `critical` are set on arcs along aligned edges.
std::vector<TMesh::Arc> straightArcs(const Parametrization& map, const MotorcycleGraph& graph);

/// The arc's leg as it is walked by `h` at its start.
TMesh::Leg firstLeg(const TMesh::Arc& arc, bool forward);

/// Whether a leg along an edge goes the way of the edge's `side`, so that side's triangle is to its left.
bool triangleOnLeft(const Parametrization& map, const TMesh::Leg& leg);

}  // namespace trimquad
