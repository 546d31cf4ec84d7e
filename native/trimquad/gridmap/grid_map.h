#pragma once

#include "trimquad/base/progress.h"
#include "trimquad/seamless/seamless_map.h"

namespace trimquad {

/// An integer grid map: transitions are grid automorphisms, singular vertices and feature points lie on grid points,
/// aligned edges on grid lines. The grid's preimage is the quad mesh. (Paper, section 6.2)
struct GridMap : Parametrization {
  double distortionStart = 0, distortionEnd = 0;  ///< mean symmetric Dirichlet energy per area, 4 for an isometry
  int iterations = 0;
};

/// The grid map nearest to a seamless map.
/// Guarantees: every triangle has positive area, all conditions of a grid map hold exactly.
GridMap gridMap(const SeamlessMap& seamless, const Progress& progress);

}  // namespace trimquad
