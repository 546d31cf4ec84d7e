#pragma once

#include <vector>

#include "trimquad/spline/fit_surface.h"

namespace trimquad {

/// Spline surfaces through a region that is cut into charts, one a chart, fitted together: equal along the
/// borders, with equal tangents across them but at singularities, where the tangents agree closely, and on
/// feature lines. Throws Error(Stage, "fit") where the tolerance cannot be met.
FittedSurface fitLayout(const Region& region, const GridMap& map, Layout layout, const FitOptions& options,
                        const Progress& progress);

}  // namespace trimquad
