#pragma once

#include <array>
#include <vector>

#include "trimquad/spline/surface_samples.h"

namespace trimquad {

/// By knot rectangle: how much the residual varies along u and v, squared, for a step of one interval.
std::vector<Eigen::Array2d> residualVariation(const SplineSpace& space,
                                              const std::vector<SurfaceSample>& samples,
                                              const std::vector<std::array<int, 3>>& cells);

/// Whether more knots along u and v would bring such a residual down.
std::array<bool, 2> directionsTakingPart(const Eigen::Array2d& variation);

/// Halves the knot intervals that hold the `failing` parameters, at a whole quad where there is one inside:
/// those of u, of v or of both, as the residual varies across the knot rectangle. Returns false where no
/// interval could be halved because it would become narrower than `narrowest`.
/// \param cells small triangles between samples, by index
bool refineKnots(SplineSpace& space, const std::vector<SurfaceSample>& samples,
                 const std::vector<std::array<int, 3>>& cells, const std::vector<Eigen::Vector2d>& failing,
                 double narrowest);

/// Halves the interval that holds `at` on one axis (0: u), unless it would become narrower than `narrowest`.
bool halveInterval(SplineSpace& space, int axis, double at, double narrowest);

}  // namespace trimquad
