#pragma once

#include <array>
#include <vector>

#include "trimquad/mesh/region.h"
#include "trimquad/spline/joined_space.h"
#include "trimquad/spline/surface_samples.h"

namespace trimquad {

/// Samples of a region that is cut into charts, dense enough for a spline space everywhere, on the true
/// surface where there is one. Parameters are those of the grid map, but next to singularities, where the map
/// grows like a power of the distance, which no spline with a tangent plane can follow: there they are moved
/// towards or away from the singularity until they grow in proportion.
class LayoutSamples {
 public:
  LayoutSamples(const Region& region, const GridMap& map, const Layout& layout, const Progress& progress);

  /// The mesh's vertices, sixteen to a knot rectangle, and as dense on the boundary and on both sides of
  /// aligned lines. `control` samples lie at other places and are denser.
  std::vector<SurfaceSample> make(const JoinedSpace& space, bool control, int threads,
                                  const Progress& progress);
  /// Of the samples made last: small triangles between samples of one chart, to see how a residual varies.
  const std::vector<std::array<int, 3>>& cells() const { return cells_; }

  double mapArea() const { return area_; }           ///< quads^2
  double triangleExtent() const { return extent_; }  ///< side of a small triangle's image, quads

  /// Whether directions around singularities are spread so that a flat surface there has linear parameters:
  /// for tolerances so fine that it is flat within them.
  bool flattens = false;

 private:
  using Corners = std::array<Eigen::Vector2d, 3>;
  Corners corners(FaceHandle f, const Transition& toChart = {}) const;
  Eigen::Vector2d at(FaceHandle f, const Eigen::Vector3d& barycentric) const;
  double areaOf(FaceHandle f) const;
  template <class Visit>
  void forEachChart(FaceHandle f, const Visit& visit) const;
  SurfaceSample sample(FaceHandle f, const Eigen::Vector3d& barycentric) const;
  void collectSingularCorners();
  bool isNearSingularity(int chart, const Corners& triangle, const SplineSpace& space) const;
  Eigen::Vector2d regularised(int chart, const Eigen::Vector2d& x) const;

  const Region& region_;
  const GridMap& map_;
  const Layout& layout_;
  /// A corner of a chart in a singularity.
  struct SingularCorner {
    Eigen::Vector2d at;
    double reach;     ///< quads
    double exponent;  ///< the surface's distance from the singularity grows like this power of the map's
  };
  double area_ = 0, extent_ = 0;
  std::vector<bool> bendsAt_;                          ///< by edge: on the boundary or an aligned line
  std::vector<std::vector<SingularCorner>> singular_;  ///< by chart
  std::vector<std::array<int, 3>> cells_;
  std::vector<Eigen::Vector3d> vertexPoint_, vertexNormal_;  ///< on the true surface
};

}  // namespace trimquad
