#pragma once

#include <array>
#include <vector>

#include "trimquad/mesh/region.h"
#include "trimquad/spline/joined_space.h"
#include "trimquad/spline/surface_samples.h"

namespace trimquad {

/// A sample of a region and the chart of the layout that its parameter belongs to.
struct LayoutSample : SurfaceSample {
  int chart = 0;
};

/// Samples of a region that is cut into charts, dense enough for a spline space everywhere, with the
/// parameters of the grid map; on the true surface where there is one.
class LayoutSamples {
 public:
  LayoutSamples(const Region& region, const GridMap& map, const Layout& layout, const Progress& progress);

  /// About sixteen to a knot rectangle, at least as dense as before; other places for `control` samples.
  std::vector<LayoutSample> make(const JoinedSpace& space, bool control, const Progress& progress);
  /// Of the samples made last: small triangles between samples of one chart, to see how a residual varies.
  const std::vector<std::array<int, 3>>& cells() const { return cells_; }

  double mapArea() const { return area_; }           ///< quads^2
  double triangleExtent() const { return extent_; }  ///< median side of a triangle's image, quads

 private:
  using Corners = std::array<Eigen::Vector2d, 3>;
  Corners corners(FaceHandle f) const;
  int latticeOrder(FaceHandle f, const JoinedSpace& space) const;
  LayoutSample sample(FaceHandle f, const Eigen::Vector3d& barycentric) const;

  const Region& region_;
  const GridMap& map_;
  const Layout& layout_;
  double area_ = 0, extent_ = 0;
  std::vector<int> order_;  ///< by triangle
  std::vector<std::array<int, 3>> cells_;
  std::vector<Eigen::Vector3d> vertexPoint_, vertexNormal_;  ///< on the true surface
};

}  // namespace trimquad
