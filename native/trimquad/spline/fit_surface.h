#pragma once

#include <limits>
#include <map>
#include <memory>

#include "trimquad/base/progress.h"
#include "trimquad/mesh/region.h"
#include "trimquad/spline/chart.h"
#include "trimquad/spline/chart_deviation.h"
#include "trimquad/spline/joined_space.h"
#include "trimquad/spline/layout.h"
#include "trimquad/spline/spline_geometry.h"

namespace trimquad {

struct FitOptions {
  double tolerance = 1e-3;  ///< largest distance between surface and region, model units
  double enough = 0;        ///< taken where `tolerance` cannot be reached; at least `tolerance`
  /// Whether the rectangle of a single surface lies as fits its region best, not along the grid.
  bool smallestRectangle = false;
  /// Charts to cut in two, again and again: by round, indices of the layout of the round before. Regions for
  /// one chart are cut as chart 0.
  std::vector<std::vector<int>> bisections = {};
  int degree = 3;  ///< 2..5
  /// Whether points of the region may slide along a single surface, which needs the fewest poles, as long as
  /// it folds over nowhere.
  bool slides = true;
  /// Whether the region's corners weigh much more: there a surface is to meet two others, and within the
  /// tolerance it may turn back just before, where it goes on beyond in another way. Costs poles.
  bool holdsCorners = false;
  int threads = 1;  ///< the result does not depend on it
  /// Given up beyond about so many control points.
  int maxPoles = std::numeric_limits<int>::max();
  /// Given up beyond about so much work, in the steps that are added to the progress's.
  long maxWork = std::numeric_limits<long>::max();
};

/// B-spline surfaces through one region, not trimmed yet: a single one where one chart holds the region, else
/// one for each chart of its layout.
struct FittedSurface {
  Chart chart;
  SplineSurface surface;
  std::optional<Layout> layout;  ///< where there are several charts; then `chart` and `surface` are empty
  std::vector<SplineSurface> surfaces;  ///< by chart of the layout
  /// Over independent samples of the region, model units; the largest over bulges between them as well.
  double maxDeviation = 0, rmsDeviation = 0;
  std::vector<ChartDeviation> deviations;  ///< by chart, one where there is a single surface
  /// Samples, those of the fit and independent ones, where a surface is turned over in a small fold, though
  /// it lies within the tolerance there; and how many samples there are.
  struct Fold {
    Eigen::Vector3d point;
    int chart;  ///< 0 where there is a single surface
  };
  std::vector<Fold> folded;
  int samples = 0;
  /// Places between samples where the surfaces are farther away than nearly all of what is enough. There are
  /// none but where no surfaces without are found.
  int bulges = 0;
  int rounds = 0;
  /// Of several surfaces: what they minimise.
  struct Continuation {
    struct Place {
      int chart;
      Eigen::Vector2d parameter;
      double emphasis;  ///< factor of the sample's weight
    };
    JoinedKnots knots;
    Fairness fairness;
    std::vector<SplineSpace> sampledOver;  ///< by chart: over whose knots the samples are spread
    std::vector<Place> samples;
  };
  std::shared_ptr<const Continuation> continuation;
};

/// Least-squares fit with parameter correction, knots refined only where the deviation exceeds the tolerance.
/// The domain is a rectangle of whole quads that holds the region's image with room on every side (except
/// around a closed direction). Small folds stay only where no surface within the tolerance is found without
/// them. Throws Error(Stage, "fit") where the tolerance cannot be met, with the deviation reached.
FittedSurface fitSurface(const Region& region, const GridMap& map, const FitOptions& options,
                         const Progress& progress);

/// Several surfaces with those of some charts smoother, as `options.enough` allows; all others stay as they
/// are, bit by bit. Empty where no smoother ones are within that.
/// \pre `fitted` has a continuation, and is of this region and map
/// \param steps by chart: of more fairness
std::optional<FittedSurface> smoothedCharts(const FittedSurface& fitted, const std::map<int, int>& steps,
                                            const Region& region, const GridMap& map,
                                            const FitOptions& options, const Progress& progress);

/// The same with the surfaces of some charts closer to the region, over halved knot intervals.
/// \param chosen charts, ascending
std::optional<FittedSurface> closerCharts(const FittedSurface& fitted, const std::vector<int>& chosen,
                                          const Region& region, const GridMap& map, const FitOptions& options,
                                          const Progress& progress);

}  // namespace trimquad
