#pragma once

#include "trimquad/tmesh/spokes.h"

namespace trimquad {

/// The T-mesh of the real arcs: walks around every patch, laid out in one chart, and completes it by virtual
/// arcs to the smallest rectangle around it (paper, sections 4.2 and 5.1).
TMesh completedPatches(const Parametrization& map, const std::vector<Seeds::Node>& nodes,
                       std::vector<TMesh::Arc> arcs);

}  // namespace trimquad
