#pragma once

#include <vector>

#include "trimquad/mesh/surface_mesh.h"

namespace trimquad {

/// Resolves triangles whose smallest height is under 1e-8 of their longest side: a cap by flipping its
/// longest side or, on the boundary, by dropping it; a needle by collapsing its shortest side. Only where no
/// other triangle turns over and the boundary stays where it is. Rewrites `soup` (an oriented manifold) and
/// `triangle` (by triangle, some number that goes along). Returns how many were resolved; throws Error(Input)
/// naming one that could not be.
int resolveFlatTriangles(TriangleSoup& soup, std::vector<int>& triangle);

}  // namespace trimquad
