#pragma once

#include <vector>

#include "trimquad/mesh/surface_mesh.h"

namespace trimquad {

/// Per edge the weight of differences between its two triangles in integrals over the surface: length of the
/// edge over the distance across it, which comes from the areas beside it. 0 on the boundary; at most 100, so
/// that needles do not bind their neighbours.
std::vector<double> dualWeights(const SurfaceMesh& mesh);

}  // namespace trimquad
