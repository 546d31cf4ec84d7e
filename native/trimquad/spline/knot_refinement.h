#pragma once

#include <vector>

#include "trimquad/spline/surface_samples.h"

namespace trimquad {

/// Halves the knot intervals that hold the `failing` parameters, at a whole quad where there is one inside:
/// those of u, of v or of both, as the residual of the samples varies across the knot rectangle. Returns
/// false where no interval could be halved because it would become narrower than `narrowest`.
bool refineKnots(SplineSpace& space, const SurfaceSamples& samples,
                 const std::vector<Eigen::Vector2d>& failing, double narrowest);

}  // namespace trimquad
