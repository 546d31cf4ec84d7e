#pragma once

#include <vector>

#include "trimquad/base/progress.h"
#include "trimquad/mesh/region.h"
#include "trimquad/spline/chart_deviation.h"
#include "trimquad/spline/fit_surface.h"
#include "trimquad/spline/surface_samples.h"

namespace trimquad {

/// Samples of a region of one chart, as dense as the knots of `surface` ask for, with their feet on it.
std::vector<SurfaceSample> samplesFor(const SplineSurface& surface, const Region& region, const GridMap& map,
                                      const Chart& chart, int threads, const Progress& progress);

/// The same of a region of several charts, by chart; without those whose feet lie in the chart beside it.
std::vector<std::vector<SurfaceSample>> samplesByChart(const FittedSurface& fitted, const Region& region,
                                                       const GridMap& map, int threads,
                                                       const Progress& progress);

/// How far the samples' region lies from a surface with about the same parameters.
ChartDeviation deviationFrom(const SplineSurface& surface, std::vector<SurfaceSample> samples, int threads,
                             const Progress& progress);

}  // namespace trimquad
