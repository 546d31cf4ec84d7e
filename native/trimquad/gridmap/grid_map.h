#pragma once

#include "trimquad/base/progress.h"
#include "trimquad/quantize/quantize.h"
#include "trimquad/seamless/seamless_map.h"
#include "trimquad/tmesh/tmesh.h"

namespace trimquad {

/// An integer grid map: transitions are grid automorphisms, singular vertices and feature points lie on grid
/// points, aligned edges on grid lines. The grid's preimage is the quad mesh. (Paper, section 6.2)
struct GridMap : Parametrization {
  MapCounters counters;
};

/// The grid map nearest to a seamless map among those whose T-mesh has the quantized lengths, by the direct
/// route: the quantization fixes translations, singular vertices, aligned lines and feature points to whole
/// quads, and the map is solved for again with these fixed. Guarantees: every triangle has positive area, all
/// conditions of a grid map hold exactly. Throws Error(Stage, "optimize") where no valid map was found.
/// \param thorough  search as long as for a seamless map; otherwise no longer than the constructive route
/// takes, which ends at the same map
GridMap gridMap(const SeamlessMap& seamless, const TMesh& tmesh, const Quantization& quantization,
                bool thorough, const Progress& progress);

}  // namespace trimquad
