#pragma once

#include "trimquad/base/progress.h"
#include "trimquad/mesh/feature_points.h"

// This order: OpenCASCADE's macros must not reach the mesh headers.
#include "trimquad/brep/cut_regions.h"

namespace trimquad {

/// Remeshes the regions of a cut model and joins them across inner curves; their triangles are split as
/// `splitConstrainedTriangles` says. Throws Error(Stage, "tessellate") where remeshing fails.
/// \param points    points of curves that become feature points; each is in the division
/// \param division  see divideCurves
Model meshedRegions(CutModel& cut, const std::vector<CurvePoint>& points,
                    const std::vector<std::vector<double>>& division, const RemeshOptions& options,
                    const Progress& progress);

}  // namespace trimquad
