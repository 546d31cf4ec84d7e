#pragma once

#include "trimquad/field/cross_field.h"

namespace trimquad {

/// Guidance of a region without its bridges, on the region with them: there is no wish over holes.
FieldGuidance overBridges(const FieldGuidance& guidance, const Region& region);

/// The other way: guidance of a region with its bridges, on the region without them.
FieldGuidance offBridges(const FieldGuidance& guidance, const Region& region);

}  // namespace trimquad
