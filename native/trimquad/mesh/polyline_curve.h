#pragma once

#include <vector>

#include "trimquad/mesh/true_surface.h"

namespace trimquad {

/// A chain of straight segments as a curve, by arc length: parameters run from 0 to the chain's length.
class PolylineCurve : public TrueCurve {
 public:
  /// At least two points, consecutive ones distinct. Closed if the last one is bitwise the first one.
  /// Throws Error(Input) otherwise.
  explicit PolylineCurve(std::vector<Eigen::Vector3d> points);

  double first() const override { return 0; }
  double last() const override { return parameter_.back(); }
  /// Exactly the chain's point where t is a vertex's parameter.
  Eigen::Vector3d point(double t) const override;
  /// Unit direction of the segment at t, of the later one at a vertex.
  Eigen::Vector3d tangent(double t) const override;
  /// The closest point within three times the distance from `p` to the point of `guess`, measured along the
  /// curve, which may pass the joint of a closed curve.
  double closest(const Eigen::Vector3d& p, double guess) const override;

  const std::vector<Eigen::Vector3d>& points() const { return points_; }
  /// By point: its parameter.
  const std::vector<double>& parameters() const { return parameter_; }

 private:
  bool closed() const { return points_.front() == points_.back(); }
  int segmentAt(double t) const;

  std::vector<Eigen::Vector3d> points_;
  std::vector<double> parameter_;
};

}  // namespace trimquad
