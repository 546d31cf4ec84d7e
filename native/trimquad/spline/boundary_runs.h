#pragma once

#include <vector>

#include "trimquad/mesh/region.h"
#include "trimquad/spline/chart.h"

namespace trimquad {

/// A stretch of a region's boundary along one model curve, from corner to corner.
struct BoundaryRun {
  int region;
  int loop;  ///< which boundary loop of the region
  CurveId curve;
  bool forward;  ///< whether the loop, with the region on its left, runs along the curve's direction
  /// Along the curve's direction: vertices, their parameters on the curve, and their places in the chart in
  /// quads, continuous along the whole loop (unwrapped over a closed chart's seam).
  std::vector<VertexHandle> vertices;
  std::vector<double> t;
  std::vector<Eigen::Vector2d> uv;

  VertexHandle from() const { return forward ? vertices.front() : vertices.back(); }
  VertexHandle to() const { return forward ? vertices.back() : vertices.front(); }
};

/// All runs of a region, loop by loop, each loop in the order in which it is walked with the region on the
/// left. Throws Error(Stage, "fit") where a boundary edge lies on no curve or a loop has no corner.
std::vector<BoundaryRun> boundaryRuns(const Model& model, int region, const Chart& chart);

}  // namespace trimquad
