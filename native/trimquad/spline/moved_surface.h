#pragma once

#include <map>
#include <optional>
#include <vector>

#include "trimquad/base/progress.h"
#include "trimquad/spline/joined_space.h"
#include "trimquad/spline/layout.h"
#include "trimquad/spline/spline_geometry.h"

namespace trimquad {

/// How a surface is to move at one of its places.
struct SurfaceMove {
  Eigen::Vector2d at;     ///< quads
  Eigen::Vector3d by;     ///< model units
  Eigen::Vector2d along;  ///< direction, in the parameter plane, in which the moves vary from place to place
  double weight;          ///< length of the curve that it is a sample of and stands for, quads
  double error;           ///< by how much it may be missed, model units; HUGE_VAL where that does not count
  bool firm = false;      ///< whether it weighs more and more while it is missed, and has narrower knot spans
};

/// The surface, with more knots, that moves as given, and less and less the further away from there: by a
/// thin plate on an elastic bed, which fades over about `fade` quads. Where no more than about `maxPoles`
/// poles bring it there, what comes close, to a tenth of the largest move at most (by their errors); empty
/// where nothing does, or where `surface` has multiple knots.
std::optional<SplineSurface> movedSurface(const SplineSurface& surface, const std::vector<SurfaceMove>& moves,
                                          double fade, int maxPoles, const Progress& progress);

/// The charts that move where some have moves: these, and those beside them; ascending.
std::vector<int> movingCharts(const Layout& layout, const std::map<int, std::vector<SurfaceMove>>& moves);

/// The same for the surfaces of a region's charts, which stay joined: those of the moving charts.
/// \param surfaces by chart \param knots how they are joined; each surface's own may have become finer
/// \param moves by chart
std::optional<std::map<int, SplineSurface>> movedSurfaces(
    const std::vector<const SplineSurface*>& surfaces, const Layout& layout, const JoinedKnots& knots,
    const std::map<int, std::vector<SurfaceMove>>& moves, double fade, int maxPoles,
    const Progress& progress);

}  // namespace trimquad
