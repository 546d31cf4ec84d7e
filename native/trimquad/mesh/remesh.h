#pragma once

#include <vector>

#include "trimquad/base/progress.h"
#include "trimquad/mesh/divide_curves.h"
#include "trimquad/mesh/region.h"

namespace trimquad {

/// Replaces a region's triangles by nearly equilateral ones of about the wanted edge length, smaller where
/// curvature asks for it, with the given boundary vertices. `region.surface` must not be null; `region` is
/// one of `model`.
///
/// Guarantees: boundary vertices are exactly the corners and the division's points; inner vertices lie on the
/// true surface; feature points stay vertices where they are; no triangle is degenerate; no inner edge joins
/// two boundary vertices. Throws Error(Stage, "tessellate") where the boundary cannot be given the wanted
/// vertices. Source: M. Botsch and L. Kobbelt, A Remeshing Approach to Multiresolution Modeling, SGP 2004.
/// \param division see divideCurves
void remesh(Region& region, const Model& model, const std::vector<std::vector<double>>& division,
            const RemeshOptions& options, const Progress& progress);

}  // namespace trimquad
