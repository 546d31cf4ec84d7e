#pragma once

#include <vector>

#include "trimquad/base/progress.h"
#include "trimquad/spline/chart_deviation.h"
#include "trimquad/spline/fit_folds.h"

namespace trimquad {

/// Samples with their feet on the fitted surfaces.
struct MeasuredSamples {
  const std::vector<SurfaceSample>& samples;
  const std::vector<FitPlace>& feet;
};

/// By chart. Each sample counts for the chart where its foot lies. The largest of them is the region's.
/// \param control independent of the fit \param own those of the fit
std::vector<ChartDeviation> deviationsByChart(int charts, const MeasuredSamples& control,
                                              const MeasuredSamples& own);

/// Gives those control samples whose feet are too far the parameters of the nearest of the fit's own, which
/// have been corrected: from the map's, the way to a foot may end on the other side of a sharp bend. Whether
/// there are any, and few enough that this can be the reason.
bool startNearby(std::vector<SurfaceSample>& control, const std::vector<SurfaceSample>& own, double tolerance,
                 int threads, const Progress& progress);

}  // namespace trimquad
