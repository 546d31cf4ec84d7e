#pragma once

#include <optional>
#include <vector>

#include "trimquad/base/progress.h"
#include "trimquad/spline/spline_geometry.h"

namespace trimquad {

/// How a surface is to move at one of its places.
struct SurfaceMove {
  Eigen::Vector2d at;     ///< quads
  Eigen::Vector3d by;     ///< model units
  Eigen::Vector2d along;  ///< direction, in the parameter plane, of the curve that the place is a sample of
  double weight;          ///< length of that curve that it stands for, quads
  bool exact;             ///< whether the error counts
};

/// The surface, with more knots, that moves as given, the exact ones within `error` (model units), and less
/// and less the further away from there: by a thin plate on an elastic bed, which fades over about a quad.
/// Where no more than about `maxPoles` poles bring it there, what comes close, to a tenth of the largest move
/// at most; empty where nothing does, or where `surface` has multiple knots.
std::optional<SplineSurface> movedSurface(const SplineSurface& surface, const std::vector<SurfaceMove>& moves,
                                          double error, int maxPoles, const Progress& progress);

}  // namespace trimquad
