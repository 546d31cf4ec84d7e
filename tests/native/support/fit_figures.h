#pragma once

#include "trimquad/gridmap/grid_map.h"
#include "trimquad/spline/fit_surface.h"

namespace trimquad::test {

/// How good a fit is, measured afresh.
struct FitFigures {
  std::size_t poles = 0;
  double max = 0, rms = 0;  ///< distance of points of the true surface
  double gap = 0;           ///< between both sides of a border, relative to the extent of the poles
  double regularJump = 0;   ///< degrees between both sides' normals, on borders away from singularities
  double singularJump = 0;  ///< the same on borders that end in a singularity
  int folds = 0;            ///< points where the surface faces backwards
};

/// The foot of a point of a triangle that lies at `x` in the triangle's chart, on the surface nearest to it.
std::pair<int, Eigen::Vector2d> footOf(const FittedSurface& fitted, const Eigen::Vector3d& p, FaceHandle f,
                                       const Eigen::Vector2d& x);

/// \param region with its true surface; the charts of `map` turn nothing around where there is a single one
FitFigures figures(const FittedSurface& fitted, const Region& region, const GridMap& map);

}  // namespace trimquad::test
