#pragma once

#include <vector>

#include "trimquad/base/progress.h"
#include "trimquad/mesh/region.h"
#include "trimquad/spline/fit_surface.h"
#include "trimquad/spline/region_errors.h"
#include "trimquad/spline/spline_model.h"
#include "trimquad/spline/trim_memory.h"

namespace trimquad {

/// Trims the fitted surfaces of a model's regions and joins them: edges shared by two regions lie on both
/// surfaces (their intersection), free edges follow the region's boundary curve within `tolerance`.
/// `fitted[i]` belongs to `model.regions[i]`; a region that failed is null, its neighbours' edges there are
/// free. Guarantees: every edge's curve agrees with its curves on the faces within the edge's tolerance
/// (measured). Throws RegionErrors with all regions that cannot be trimmed, as far as the first step at which
/// one fails shows them. \param tolerance largest distance of a free edge from the boundary curve, model
/// units \param memory of earlier trims; the result does not depend on it
SplineModel trimModel(const Model& model, const std::vector<const GridMap*>& maps,
                      const std::vector<const FittedSurface*>& fitted, double tolerance,
                      const Progress& progress, int threads = 1, TrimMemory* memory = nullptr);

/// The fit of a region whose surface was moved (SplineModel::moved), with the surface and the deviations that
/// it has in the model.
FittedSurface fittedAsMoved(const FittedSurface& fitted, const SplineModel& model, int region);

}  // namespace trimquad
