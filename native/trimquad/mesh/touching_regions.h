#pragma once

#include <vector>

#include "trimquad/mesh/region.h"

namespace trimquad {

/// The regions that have a corner of the model in common with a region, ascending; it is one of them itself
/// unless it has no boundary.
std::vector<int> touchingRegions(const Model& model, int region);

}  // namespace trimquad
