#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "trimquad/spline/spline_model.h"

namespace trimquad {

/// The surface over one knot rectangle, inside the hull of its Bézier points.
struct FaceCell {
  std::vector<Eigen::Vector3d> points;
  Eigen::AlignedBox3d box;
};

/// The knot rectangles of a face's surface that its trim reaches, and perhaps some beside it. (Farin, Curves
/// and Surfaces for CAGD: convex hull property; Ramshaw, blossoming)
std::vector<FaceCell> faceCells(const SplineFace& face);

}  // namespace trimquad
