#pragma once

#include <vector>

#include "trimquad/field/cross_field.h"

namespace trimquad {

/// By face, the factor by which a conformal map that follows the field would enlarge the triangle, mean
/// square
/// 1. Scaled by it the field is nearly a gradient, so that its Poisson map winds around cones as it should;
/// with unit lengths a cone of more than a full turn can collapse into one of less.
/// Least squares of (change of the logarithm along an edge) = (turn of the field across it) * length / width.
std::vector<double> conformalScale(const SurfaceMesh& mesh, const CrossField& field);

}  // namespace trimquad
