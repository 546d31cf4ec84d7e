#pragma once

#include <array>
#include <vector>

#include "trimquad/base/progress.h"
#include "trimquad/mesh/region.h"
#include "trimquad/spline/corner_moves.h"
#include "trimquad/spline/fit_surface.h"
#include "trimquad/spline/trim_curve.h"

namespace trimquad {

/// A curve along which two sheets, that were fitted apart, touch.
struct TangentCurve {
  struct Side {
    int sheet;
    bool onLeft;  ///< of the curve, seen from outside
  };
  const SampledCurve* sampled;
  std::array<Side, 2> sides;
  bool smooth;                          ///< whether the curve is the model's own, no chain of mesh edges
  double gap;                           ///< what may be left between the sheets, model units
  std::array<int, 2> corners;           ///< of the model, at its start and end
  std::array<Eigen::Vector3d, 2> ends;  ///< where these are: models have curves that end a little off them
  std::array<bool, 2>
      tangent;  ///< whether the sheets stay tangent around these, if curves fix their planes there
};

/// Largest gap that two sheets have after one has moved onto the other, by the model's diagonal.
inline constexpr double kTangentGap = 2e-7;

struct JoinedSheets {
  std::vector<int> moved;    ///< the bodies that have moved, ascending
  std::vector<char> folded;  ///< by curve: whether its sheets now have a slight edge there
  std::vector<std::vector<TangentStretch>> tangent;  ///< by curve that is folded: where they have none
};

/// How sheets are to be joined, model units.
struct JoinLimits {
  double width;         ///< half of that of the strip in which one comes to be nearly tangent to the other
  double gap;           ///< what may be left between them in corners
  double tangentError;  ///< by how much they may miss a curve where they make no edge
};

/// Moves sheets so that they agree with the others on the curves along which these touch them, and nearly in
/// a strip around, and in the corners in which such curves end. Where both may move and the curve is smooth,
/// both come to lie on it, and are turned about it until they make an edge of a fraction of a degree (a
/// fold), so that they have a well-defined intersection; else one moves onto the other, the later one, the
/// single one, or the one that may. Around corners that say so, in which several such curves fix a sheet's
/// tangent plane, and where an edge changes from a ridge to a valley, the sheets stay tangent.
JoinedSheets joinTangentSheets(std::vector<Sheet>& sheets, const std::vector<TangentCurve>& curves,
                               const std::vector<SheetCorner>& corners, const JoinLimits& limits, int threads,
                               const SheetMover& mover);

/// Sine of the angle between folded sheets from which on their intersection is looked for.
inline constexpr double kSmallestFold = 5e-4;

}  // namespace trimquad
