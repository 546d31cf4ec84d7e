#pragma once

#include <array>
#include <vector>

#include "trimquad/base/progress.h"
#include "trimquad/mesh/region.h"
#include "trimquad/spline/chart.h"
#include "trimquad/spline/spline_space.h"

namespace trimquad {

/// A point of a region, and where a spline surface comes closest to it.
struct SurfaceSample {
  Eigen::Vector3d point, normal;
  Eigen::Vector2d parameter;  ///< quads; in a closed direction within one period of the seam
  double weight = 0;          ///< area of the chart that it stands for, quads^2
  double distance = 0;        ///< from the surface, along its normal: signed, model units
};

/// Samples of a region, dense enough for a spline space everywhere: the mesh vertices, points inside the
/// triangles and on the boundary, all moved onto the true surface where there is one.
class SurfaceSamples {
 public:
  /// \param seam first u of a closed chart
  SurfaceSamples(const Region& region, const GridMap& map, const Chart& chart, double seam,
                 const Progress& progress);

  /// Adds samples so that every knot rectangle under the region holds about sixteen. Samples that exist keep
  /// their parameters; new ones start from the chart.
  void refine(const SplineSpace& space, const Progress& progress);

  /// Samples at other places, denser than those of `samples`; parameters as for new ones.
  const std::vector<SurfaceSample>& control(const SplineSpace& space, const Progress& progress);

  /// By sample: what the chart says.
  const std::vector<Eigen::Vector2d>& chartParameters() const { return chartParameter_; }

  std::vector<SurfaceSample> samples;
  /// Small triangles between samples, to see how a residual varies.
  const std::vector<std::array<int, 3>>& cells() const { return cells_; }

  double chartArea() const { return chartArea_; }    ///< quads^2
  double triangleExtent() const { return extent_; }  ///< median side of a triangle's chart image, quads
  /// `to` - `from`, by the shorter way around a closed chart.
  Eigen::Vector2d difference(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const;

 private:
  using Corners = std::array<Eigen::Vector2d, 3>;
  Corners chartCorners(HalfedgeHandle h) const;
  Eigen::Vector2d wrapped(Eigen::Vector2d x) const;
  SurfaceSample sample(HalfedgeHandle h, const Eigen::Vector3d& barycentric) const;
  int latticeOrder(FaceHandle f, const SplineSpace& space) const;
  void appendFace(FaceHandle f, int order, std::vector<SurfaceSample>& to) const;
  void appendBoundary(HalfedgeHandle inner, int order, std::vector<SurfaceSample>& to) const;

  const Region& region_;
  const SurfaceMesh& mesh_;
  const Chart& chart_;
  double seam_, period_ = 0, chartArea_ = 0, extent_ = 0;
  std::vector<HalfedgeHandle> boundary_;  ///< inner halfedges
  std::vector<std::array<int, 3>> cells_;
  std::vector<int> order_, controlOrder_;           ///< by face; 0 where not sampled yet
  std::vector<int> firstOfFace_, firstOfBoundary_;  ///< in `samples`
  std::vector<SurfaceSample> control_;
  std::vector<Eigen::Vector2d> chartParameter_;  ///< by sample
};

}  // namespace trimquad
