#pragma once

#include <array>
#include <optional>
#include <vector>

#include "trimquad/mesh/region.h"
#include "trimquad/spline/chart.h"
#include "trimquad/spline/layout.h"

namespace trimquad {

/// A vertex at the end of a boundary run: which corner, and which vertex of the region (its boundary may
/// touch itself in one corner). Corners after those of the model are places where charts meet, of this region
/// or of the one across; they have no vertex (negative, by corner).
struct RunEnd {
  int corner, vertex;
  std::optional<int> point = {};  ///< of the region's layout, where its own charts meet in such a corner
};

/// A stretch of a chart's boundary along one model curve, from corner to corner.
struct BoundaryRun {
  int region;
  int chart;  ///< of the region's layout; 0 where there is one only
  /// Which loop of the chart, which stretch of it, which place in the stretch: ascending along the loop.
  std::array<int, 3> place;
  CurveId curve;
  bool forward;  ///< whether the loop, with the region on its left, runs along the curve's direction
  RunEnd start, end;
  /// Along the curve's direction: points, their parameters on the curve, and their places in the chart in
  /// quads, continuous along the whole loop (unwrapped over a closed chart's seam).
  std::vector<Eigen::Vector3d> points;
  std::vector<double> t;
  std::vector<Eigen::Vector2d> uv;
};

/// A place on a model curve where borders between charts end, away from the curve's own ends.
struct CurveSplit {
  CurveId curve;
  double t;
  int corner;         ///< number of the corner that it makes
  int region, point;  ///< of the region's layout
};

/// All runs of a region, loop by loop, each loop in the order in which it is walked with the region on the
/// left. Throws Error(Stage, "fit") where a boundary edge lies on no curve or a loop has no corner.
std::vector<BoundaryRun> boundaryRuns(const Model& model, int region, const Chart& chart);

/// The same for a region that is cut into charts; runs end where charts meet. Appends these places to
/// `splits`, with corner numbers from `corners` on.
std::vector<BoundaryRun> boundaryRuns(const Model& model, int region, const Layout& layout, int& corners,
                                      std::vector<CurveSplit>& splits);

/// Moves an end of a run to another place of its curve; what lies beyond it is left out.
void startAt(BoundaryRun& run, double t, const Eigen::Vector3d& point);
void endAt(BoundaryRun& run, double t, const Eigen::Vector3d& point);

/// Cuts the runs that pass over a split there.
void cutAtSplits(const Model& model, const std::vector<CurveSplit>& splits, std::vector<BoundaryRun>& runs);

}  // namespace trimquad
