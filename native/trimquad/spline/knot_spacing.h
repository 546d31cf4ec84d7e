#pragma once

#include <array>
#include <vector>

#include "trimquad/spline/spline_space.h"
#include "trimquad/spline/surface_samples.h"

namespace trimquad {

/// By span of a space's line u and of its line v: how many knot intervals are to take its place, a fraction
/// where the span may be longer.
using KnotDemand = std::array<std::vector<double>, 2>;

/// The demand of a surface over the space for a deviation: intervals of a length h cost h^(degree + 1) times
/// the surface's bending along the line, which is estimated from the jumps of its highest derivatives along
/// its normal. (de Boor, A Practical Guide to Splines, XII, "newnot") Both directions cost the same.
/// \param samples of the surface, at their feet
KnotDemand demandOfBending(const SplineSurface& surface, const SplineSpace& space,
                           const std::vector<SurfaceSample>& samples, double deviation);

/// Scales the demand so that a space asks for so many poles at most, about.
void limitPoles(KnotDemand& demand, const SplineSpace& space, double poles);

/// As many intervals as there are, more where samples of a fit over the space deviate too much, and up to
/// the part `least` of them where they deviate by less.
KnotDemand demandOfResidual(const SplineSpace& space, const std::vector<SurfaceSample>& samples,
                            const std::vector<std::array<int, 3>>& cells, double deviation, double least);

/// The line with knots where the demand wants them, at multiples of a small power of two.
SplineLine respaced(const SplineLine& line, const std::vector<double>& demand);

}  // namespace trimquad
