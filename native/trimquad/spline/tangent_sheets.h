#pragma once

#include <functional>
#include <vector>

#include "trimquad/base/progress.h"
#include "trimquad/mesh/region.h"
#include "trimquad/spline/corner_moves.h"
#include "trimquad/spline/fit_surface.h"
#include "trimquad/spline/trim_curve.h"

namespace trimquad {

/// A curve along which two sheets, that were fitted apart, touch.
struct TangentCurve {
  const SampledCurve* sampled;
  int sheet[2];                    ///< by side
  const TrueSurface* behind[2]{};  ///< by side: what the sheet was fitted to, where it ends on this very curve
};

/// Largest gap that two sheets have after one has moved onto the other, by the model's diagonal.
inline constexpr double kTangentGap = 2e-7;

/// Moves sheets so that they agree with the others on the curves along which these touch them, and nearly in
/// a strip around, and in the corners in which such curves end. Where both may move and the surfaces behind
/// them are known, both come to lie on the curve, tangent to these; else one moves onto the other, the later
/// one, or the one that may. \param mayMove by sheet \param width   half of the strip's, model units \param gap     what may
/// be left between the sheets, model units \param accepts (sheet, new surface) whether it may become so
/// Returns the sheets that have moved, ascending.
std::vector<int> joinTangentSheets(std::vector<Sheet>& sheets, const std::vector<TangentCurve>& curves,
                                   const std::vector<SheetCorner>& corners, const std::vector<char>& mayMove,
                                   double width, double gap,
                                   const std::function<bool(int, const SplineSurface&)>& accepts,
                                   const Progress& progress);

/// How far a region of one chart lies from a surface other than the fitted one.
ChartDeviation deviationFrom(const SplineSurface& surface, const Region& region, const GridMap& map,
                             const FittedSurface& fitted, int threads, const Progress& progress);

}  // namespace trimquad
