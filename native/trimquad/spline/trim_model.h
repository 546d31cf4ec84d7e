#pragma once

#include <vector>

#include "trimquad/base/progress.h"
#include "trimquad/mesh/region.h"
#include "trimquad/spline/fit_surface.h"
#include "trimquad/spline/region_errors.h"
#include "trimquad/spline/spline_model.h"
#include "trimquad/spline/trim_memory.h"

namespace trimquad {

struct TrimOptions {
  double tolerance = 1e-3;  ///< largest distance of a free edge from the boundary curve, model units
  /// How far a region may be from a surface that is moved to agree with its neighbours; at least `tolerance`.
  double enough = 0;
  int threads = 1;               ///< the result does not depend on it
  TrimMemory* memory = nullptr;  ///< of earlier trims; neither does it on this
};

/// Trims the fitted surfaces of a model's regions and joins them: edges shared by two regions lie on both
/// surfaces (their intersection), free edges follow the region's boundary curve within the tolerance.
/// `fitted[i]` belongs to `model.regions[i]`; a region that failed is null, its neighbours' edges there are
/// free. Guarantees: every edge's curve agrees with its curves on the faces within the edge's tolerance
/// (measured). Throws RegionErrors with all regions that cannot be trimmed, as far as the first step at which
/// one fails shows them.
SplineModel trimModel(const Model& model, const std::vector<const GridMap*>& maps,
                      const std::vector<const FittedSurface*>& fitted, const TrimOptions& options,
                      const Progress& progress);

/// The fit of a region whose surface was moved (SplineModel::moved), with the surface and the deviations that
/// it has in the model.
FittedSurface fittedAsMoved(const FittedSurface& fitted, const SplineModel& model, int region);

}  // namespace trimquad
