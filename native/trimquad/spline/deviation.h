#pragma once

#include <cmath>
#include <vector>

#include "trimquad/spline/surface_samples.h"

namespace trimquad {

/// Last step of the search for a sample's foot, relative to its parameters: the distance is exact up to
/// rounding then.
inline constexpr double kFootStep = 1e-6;

/// How far a region's samples lie from a surface.
struct Deviation {
  double max = 0, rms = 0;
  int worst = -1;               ///< index of the sample
  std::vector<int> turnedOver;  ///< samples where the surface's normal points the other way
};

/// \param turnedOver by sample
inline Deviation deviationOf(const std::vector<SurfaceSample>& samples, const std::vector<char>& turnedOver) {
  Deviation result;
  double sum = 0;
  for (int i = 0; i < int(samples.size()); ++i) {
    const double distance = std::abs(samples[i].distance);
    sum += distance * distance;
    if (result.worst < 0 || distance > result.max) {
      result.max = distance;
      result.worst = i;
    }
    if (turnedOver[i]) result.turnedOver.push_back(i);
  }
  result.rms = std::sqrt(sum / double(std::max<std::size_t>(1, samples.size())));
  return result;
}

}  // namespace trimquad
