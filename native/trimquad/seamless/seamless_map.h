#pragma once

#include "trimquad/base/progress.h"
#include "trimquad/field/cross_field.h"
#include "trimquad/mesh/parametrization.h"
#include "trimquad/mesh/region.h"

namespace trimquad {

/// A seamless map of a region, in units of the target edge length; exact and locally injective.
struct SeamlessMap : Parametrization {
  int flippedBefore = 0;  ///< triangles that the Poisson solve turned over
  int iterations = 0;     ///< Newton steps
};

/// The seamless map whose gradients follow `field`, scaled so that one quad is `edgeLength` (model units) wide.
SeamlessMap seamlessMap(const Region& region, const CrossField& field, double edgeLength, const Progress& progress);

}  // namespace trimquad
