#include "trimquad/spline/fit_control.h"

#include <algorithm>
#include <cmath>

#include "trimquad/base/parallel.h"

namespace trimquad {
namespace {

/// Part of the control samples at most that may have started from bad parameters.
constexpr double kFewLost = 0.01;

}  // namespace

std::vector<ChartDeviation> deviationsByChart(int charts, const MeasuredSamples& control,
                                              const MeasuredSamples& own) {
  std::vector<ChartDeviation> result(charts);
  std::vector<int> counts(charts, 0);
  const auto take = [&](const MeasuredSamples& measured, bool independent) {
    for (std::size_t i = 0; i < measured.samples.size(); ++i) {
      const int chart = measured.feet[i].chart;
      ChartDeviation& d = result[chart];
      const double distance = std::abs(measured.samples[i].distance);
      if (distance >= d.max) {
        d.max = distance;
        d.where = measured.samples[i].point;
      }
      if (!independent) continue;
      d.rms += distance * distance;
      ++counts[chart];
    }
  };
  take(control, true);
  take(own, false);
  for (int c = 0; c < charts; ++c) result[c].rms = std::sqrt(result[c].rms / std::max(1, counts[c]));
  return result;
}

bool startNearby(std::vector<SurfaceSample>& control, const std::vector<SurfaceSample>& own, double tolerance,
                 int threads, const Progress& progress) {
  std::vector<SurfaceSample*> lost;
  for (auto& s : control)
    if (!(std::abs(s.distance) <= tolerance)) lost.push_back(&s);
  if (lost.empty() || double(lost.size()) > kFewLost * double(control.size())) return false;
  parallelParts(int(lost.size()), threads, [&](int begin, int end) {
    progress.check();
    for (int i = begin; i < end; ++i) {
      const SurfaceSample* nearest = nullptr;
      for (const auto& s : own)
        if (s.normal.dot(lost[i]->normal) > 0 &&
            (!nearest ||
             (s.point - lost[i]->point).squaredNorm() < (nearest->point - lost[i]->point).squaredNorm()))
          nearest = &s;
      if (!nearest) continue;
      lost[i]->chart = nearest->chart;
      lost[i]->parameter = nearest->parameter;
    }
  });
  return true;
}

}  // namespace trimquad
