#include "trimquad/spline/moved_deviation.h"

#include "trimquad/base/parallel.h"
#include "trimquad/spline/deviation.h"
#include "trimquad/spline/layout_samples.h"

namespace trimquad {
namespace {

/// Replaces the samples' parameters by those of their feet, and their distances.
void findFeet(const SplineSurface& surface, std::vector<SurfaceSample>& samples, int threads,
              const Progress& progress) {
  parallelParts(int(samples.size()), threads, [&](int begin, int end) {
    progress.check();
    for (int i = begin; i < end; ++i) {
      auto& s = samples[i];
      s.parameter = surface.footPoint(s.point, {surface.wrappedU(s.parameter[0]), s.parameter[1]}, kFootStep);
      s.distance = (surface.point(s.parameter[0], s.parameter[1]) - s.point).norm();
    }
  });
}

}  // namespace

std::vector<SurfaceSample> samplesFor(const SplineSurface& surface, const Region& region, const GridMap& map,
                                      const Chart& chart, int threads, const Progress& progress) {
  if (map.mesh.n_faces() == 0) return {};
  SplineSpace space{{surface.degreeU, surface.closedU, {}}, {surface.degreeV, false, {}}};
  space.u.breaks.assign(surface.knotsU.begin() + surface.degreeU, surface.knotsU.end() - surface.degreeU);
  space.v.breaks.assign(surface.knotsV.begin() + surface.degreeV, surface.knotsV.end() - surface.degreeV);
  SurfaceSamples source(region, map, chart, surface.firstU(), progress);
  auto samples = source.make(space, true, threads, progress);
  findFeet(surface, samples, threads, progress);
  return samples;
}

std::vector<std::vector<SurfaceSample>> samplesByChart(const FittedSurface& fitted, const Region& region,
                                                       const GridMap& map, int threads,
                                                       const Progress& progress) {
  std::vector<std::vector<SurfaceSample>> result(fitted.surfaces.size());
  JoinedSpace space(*fitted.layout);
  space.charts = fitted.continuation->knots.charts;
  LayoutSamples source(region, map, *fitted.layout, progress);
  for (auto& sample : source.make(space, true, threads, progress))
    result[sample.chart].push_back(std::move(sample));
  for (std::size_t c = 0; c < result.size(); ++c) {
    findFeet(fitted.surfaces[c], result[c], threads, progress);
    std::erase_if(result[c], [&](const SurfaceSample& s) { return s.distance > fitted.maxDeviation; });
  }
  return result;
}

ChartDeviation deviationFrom(const SplineSurface& surface, std::vector<SurfaceSample> samples, int threads,
                             const Progress& progress) {
  findFeet(surface, samples, threads, progress);
  const Deviation deviation = deviationOf(samples, std::vector<char>(samples.size(), 0));
  ChartDeviation result;
  result.max = deviation.max;
  result.rms = deviation.rms;
  if (deviation.worst >= 0) result.where = samples[deviation.worst].point;
  return result;
}

}  // namespace trimquad
