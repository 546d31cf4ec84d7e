#pragma once

#include <array>
#include <vector>

#include "trimquad/base/progress.h"
#include "trimquad/mesh/region.h"
#include "trimquad/spline/chart.h"
#include "trimquad/spline/spline_space.h"

namespace trimquad {

/// Samples along a side of a knot rectangle.
inline constexpr int kSamplesAcrossSpan = 4;
/// The same of control samples of a single surface: where the boundary cuts off part of a knot rectangle, few
/// of the fit's are left in it.
inline constexpr int kControlsAcrossSpan = 7;
/// One triangle in this many is smaller than the extent that is given for them.
inline constexpr std::size_t kSmallTriangles = 20;
/// Part of the weight that the mesh's vertices carry.
inline constexpr double kVertexShare = 0.5;
/// Width of the strip along the boundary whose weight the boundary's samples carry in addition, quads.
inline constexpr double kBoundaryStrip = 0.25;

/// A point of a region, and where a spline surface comes closest to it.
struct SurfaceSample {
  Eigen::Vector3d point, normal;
  Eigen::Vector3d
      meshNormal;             ///< of the triangles: differs where the surface bends more closely than they do
  int chart = 0;              ///< of the layout, where there are several
  Eigen::Vector2d parameter;  ///< quads; in a closed direction within one period of the seam
  double weight = 0;          ///< area of the chart that it stands for, quads^2
  /// Projects onto the directions in which its foot may move: none where the parameter is not a foot's.
  Eigen::Matrix3d free = Eigen::Matrix3d::Zero();
  double distance = 0;  ///< from the surface, along its normal: signed, model units

  /// Whether a surface with the given normal has its outside here where the region has it.
  bool agrees(const Eigen::Vector3d& n) const { return n.dot(normal) > 0 || n.dot(meshNormal) > 0; }
};

/// Moves those of the samples that lie on the region's triangles onto its true surface, if it has one; their
/// normals become that one's. \param chosen indices of samples
void moveOntoTrueSurface(const Region& region, const std::vector<int>& chosen,
                         std::vector<SurfaceSample>& samples, int threads, const Progress& progress);

/// Samples of a region, dense enough for a spline space everywhere: the mesh vertices, points inside the
/// triangles and on the boundary, all moved onto the true surface where there is one.
class SurfaceSamples {
 public:
  /// \param seam first u of a closed chart
  SurfaceSamples(const Region& region, const GridMap& map, const Chart& chart, double seam,
                 const Progress& progress);

  /// The mesh's vertices, sixteen to a knot rectangle, and as dense on the boundary, with the chart's
  /// parameters. `control` samples lie at other places and are denser.
  std::vector<SurfaceSample> make(const SplineSpace& space, bool control, int threads,
                                  const Progress& progress);
  /// Of the samples made last: small triangles between samples, to see how a residual varies.
  const std::vector<std::array<int, 3>>& cells() const { return cells_; }

  double chartArea() const { return chartArea_; }    ///< quads^2
  double triangleExtent() const { return extent_; }  ///< side of a small triangle's chart image, quads

 private:
  using Corners = std::array<Eigen::Vector2d, 3>;
  Corners chartCorners(HalfedgeHandle h) const;
  Eigen::Vector2d wrapped(Eigen::Vector2d x) const;
  SurfaceSample sample(HalfedgeHandle h, const Eigen::Vector3d& barycentric) const;
  double areaOf(FaceHandle f) const;

  const Region& region_;
  const SurfaceMesh& mesh_;
  const Chart& chart_;
  double seam_, period_ = 0, chartArea_ = 0, extent_ = 0;
  std::vector<HalfedgeHandle> boundary_;  ///< inner halfedges
  std::vector<std::array<int, 3>> cells_;
  std::vector<SurfaceSample> vertices_;
};

}  // namespace trimquad
