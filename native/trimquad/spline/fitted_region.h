#pragma once

#include <optional>

#include "trimquad/mesh/aabb_tree.h"
#include "trimquad/mesh/region.h"
#include "trimquad/spline/spline_geometry.h"

namespace trimquad {

/// How far a surface is from the region at one of its places, and the region's point there.
struct Bulge {
  double distance;
  Eigen::Vector3d point;
};

/// The region that surfaces are fitted to, as seen from places of these.
class FittedRegion {
 public:
  /// \param tolerance, enough see FitOptions
  FittedRegion(const Region& region, double tolerance, double enough);

  const TriangleTree& triangles() const { return triangles_; }
  /// Of the true surface, where there is one.
  Eigen::Vector3d closest(const Eigen::Vector3d& p) const;
  /// Whether the region faces that way within what is enough of a point: small curls of it may be flattened.
  bool facesLikewise(const Eigen::Vector3d& p, const Eigen::Vector3d& normal) const;
  /// From how far away on there are bulges: somewhat less than is enough, for the places beside them, where
  /// the tolerance leaves any.
  double limit() const;
  /// Where a surface is farther away than that; none elsewhere. Beyond the boundary it counts where it is
  /// less far beyond than above or below: the rest is trimmed off. Of a true surface the triangles are a
  /// coarse picture, so that it is asked where these are far.
  std::optional<Bulge> farther(const SplineSurface::Jet& jet, double than) const;

 private:
  bool isOnBoundary(const TriangleTree::Hit& hit) const;

  const Region& region_;
  const TriangleTree triangles_;
  const double tolerance_, enough_;
};

}  // namespace trimquad
