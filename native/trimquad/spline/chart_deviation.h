#pragma once

#include <Eigen/Core>

namespace trimquad {

/// How far a part of a region lies from its surface.
struct ChartDeviation {
  double max = 0;                                   ///< over independent samples and those of the fit
  double rms = 0;                                   ///< over independent samples
  Eigen::Vector3d where = Eigen::Vector3d::Zero();  ///< the region's point that lies farthest away
};

}  // namespace trimquad
