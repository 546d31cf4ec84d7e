#pragma once

#include "trimquad/gridmap/grid_map.h"
#include "trimquad/gridmap/patch_map.h"

namespace trimquad {

/// The grid map that Newton steps lead to from a constructed one, on its mesh: nearer to the seamless map and
/// to an isometry, with the same integers (paper, section 6.2). Every triangle stays positive throughout.
GridMap optimizedPatchMap(const SeamlessMap& seamless, const PatchMap& patches, const Progress& progress);

}  // namespace trimquad
