#pragma once

#include "trimquad/base/progress.h"
#include "trimquad/mesh/parametrization.h"
#include "trimquad/tmesh/tmesh.h"

namespace trimquad {

/// The free-boundary motorcycle graph of a seamless map, with virtual arcs (paper, section 4). Motorcycles
/// start in all axis directions from singularities, feature points, and corners, ends and junctions of
/// aligned curves, and in the directions that they see from concave peaks of free boundaries. Where two meet,
/// the one that comes later stops. The result is exact and does not depend on the charts' rotations and cuts.
/// The mesh must be connected. Throws Error(Input, "partition") where the map is not valid (see `verify` of a
/// parametrization).
TMesh partition(const Parametrization& map, const Progress& progress);

}  // namespace trimquad
