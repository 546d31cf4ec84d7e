#pragma once

#include "trimquad/field/cross_field.h"

namespace trimquad {

/// The directions of largest principal curvature, exact where the region has a true surface, estimated from
/// the triangles elsewhere. The weight tells how distinct the two principal directions are: the angle by
/// which the surface bends more in one than in the other over the region's size, against one radian.
FieldGuidance curvatureGuidance(const Region& region, const Progress& progress);

}  // namespace trimquad
