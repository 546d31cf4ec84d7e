#pragma once

#include <Eigen/Geometry>
#include <set>
#include <variant>
#include <vector>

#include "trimquad/brep/face_cells.h"

namespace trimquad {

/// Tells faces of a model apart by their poles and Bézier points, in whose convex hulls they lie.
class FaceSeparation {
 public:
  explicit FaceSeparation(const SplineModel& model);

  /// Whether two faces surely have nothing in common but edges and vertices that both use: further apart than
  /// tolerances reach, or both flat and one, but for what they share, on one side of the other's plane. False
  /// says nothing.
  bool areApart(int a, int b) const;

 private:
  struct Flat {
    Eigen::Hyperplane<double, 3> plane;
    Eigen::Matrix<double, 2, 3> axes;  ///< of a rectangle around it
    Eigen::AlignedBox2d rectangle;     ///< in these axes
  };
  struct Face {
    std::variant<Flat, std::vector<FaceCell>> shape;
    Eigen::AlignedBox3d box;
    double tolerance = 0;  ///< how far poles, edges and vertices may be off
    std::set<SplineEdgeId> edges;
    std::set<SplineVertexId> vertices;
  };

  bool isBeside(const Face& face, const Face& other, const Flat& flat, double distance) const;

  const SplineModel& model_;
  std::vector<Face> faces_;
};

}  // namespace trimquad
