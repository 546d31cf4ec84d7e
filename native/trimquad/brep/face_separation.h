#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <set>
#include <vector>

#include "trimquad/spline/spline_model.h"

namespace trimquad {

/// Tells faces of a model apart by their poles, in whose convex hulls they lie.
class FaceSeparation {
 public:
  explicit FaceSeparation(const SplineModel& model);

  /// Whether two faces surely have nothing in common but edges and vertices that both use: one is flat, and
  /// the other one on one side of its plane, further off than tolerances reach, but for what they share. Only
  /// flat faces may share something. False says nothing.
  bool areApart(int a, int b) const { return isBeside(a, b) || isBeside(b, a); }

 private:
  struct Face {
    std::optional<Eigen::Hyperplane<double, 3>> plane;  ///< of flat ones
    double tolerance = 0;                               ///< how far its poles, edges and vertices may be off
    std::set<SplineEdgeId> edges;
    std::set<SplineVertexId> vertices;
  };

  bool isBeside(int face, int flat) const;

  const SplineModel& model_;
  std::vector<Face> faces_;
};

}  // namespace trimquad
