#pragma once

#include <Eigen/Core>
#include <vector>

#include "trimquad/mesh/surface_mesh.h"

namespace trimquad {

/// A frame in each triangle and the angles between neighbouring frames.
struct Transport {
  std::vector<Eigen::Vector3d> axisU, axisV;  ///< by face: orthonormal, axisU x axisV the triangle's normal
  /// By halfedge index, from the face of the halfedge to that of its opposite: a direction at angle a in the
  /// first frame is parallel to a + angle in the second. Antisymmetric. 0 on the boundary.
  std::vector<double> angle;

  /// Angle of `direction` in the frame of `f`, in (-pi, pi].
  double angleOf(FaceHandle f, const Eigen::Vector3d& direction) const;
  Eigen::Vector3d direction(FaceHandle f, double angle) const;
};

/// 2 pi minus the corner angles around an interior vertex.
double gaussCurvature(const SurfaceMesh& mesh, VertexHandle v);

/// Angles in (-pi, pi], of any mesh without zero-area triangles.
Transport principalTransport(const SurfaceMesh& mesh);

/// Angles that are real numbers, not numbers modulo a full turn: around every interior vertex,
/// counter-clockwise, they add up to the vertex's Gauss curvature exactly, so that a field given by a
/// single-valued angle function has no singularity.
/// \pre a connected mesh with a boundary, of genus 0. Frames are free on a spanning tree of triangles; the
/// lifts of the other angles are settled vertex by vertex from the leaves of the complementary tree.
Transport liftedTransport(const SurfaceMesh& mesh);

}  // namespace trimquad
