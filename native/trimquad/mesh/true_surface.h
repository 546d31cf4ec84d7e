#pragma once

#include <Eigen/Core>

namespace trimquad {

/// The surface that a region's triangles approximate. Implementations are safe to call from several threads.
class TrueSurface {
 public:
  virtual ~TrueSurface() = default;

  struct Foot {
    Eigen::Vector3d point,
        normal;  ///< closest point, and the unit normal there, on the side of the triangles
  };
  /// The point of the surface closest to `p` (model units), which lies near the surface.
  virtual Foot closest(const Eigen::Vector3d& p) const = 0;
  /// The same among the points whose normal makes less than a right angle with `facing`, as far as there are
  /// any: `p` may lie closer to the other side of a thin part.
  virtual Foot closestFacing(const Eigen::Vector3d& p, const Eigen::Vector3d& facing) const = 0;

  struct Curvature {
    Eigen::Vector3d direction1, direction2;  ///< unit principal directions
    double k1, k2;                           ///< principal curvatures, 1 / model unit
  };
  /// Principal curvatures at the point closest to `p`.
  virtual Curvature curvature(const Eigen::Vector3d& p) const = 0;
};

/// A curve on which a region ends: a CAD edge, or a piece of a mesh's boundary. Shared by all regions that
/// end there.
class TrueCurve {
 public:
  virtual ~TrueCurve() = default;
  virtual double first() const = 0;
  virtual double last() const = 0;
  virtual Eigen::Vector3d point(double t) const = 0;
  virtual Eigen::Vector3d tangent(double t) const = 0;  ///< derivative with respect to t
  /// Parameter of the point closest to `p`, near `guess`.
  virtual double closest(const Eigen::Vector3d& p, double guess) const = 0;
};

}  // namespace trimquad
