#pragma once

#include "trimquad/gridmap/patch_map.h"
#include "trimquad/seamless/seamless_map.h"

namespace trimquad {

/// A grid map with as few seams as a tree of its triangles leaves, turned the way of the seamless map that it
/// comes from, and all that binds it to the grid: input of a solve that starts from it.
struct IntegerCharts {
  Parametrization map;
  SeamGraph seams;              ///< one branch for each different transition
  SeamConstraints constraints;  ///< all translations, critical nodes and aligned edges as in the map
  MapTarget target;             ///< the seamless map's, in the triangles of this mesh
};

IntegerCharts integerCharts(const SeamlessMap& seamless, const PatchMap& patches);

}  // namespace trimquad
