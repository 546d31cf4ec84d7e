#pragma once

#include "trimquad/mesh/aabb_tree.h"
#include "trimquad/mesh/surface_mesh.h"
#include "trimquad/mesh/true_surface.h"

namespace trimquad {

/// The triangles themselves as the surface. `closest` is exact; its normal is the triangle's. Curvature is
/// estimated: at each vertex from the quadric through it that fits its 2-ring best, blended over the
/// triangle. Principal curvatures are ordered k1 >= k2, positive where the surface bends towards its normal
/// (a sphere with outward normals has negative ones). Source: S. Petitjean, A survey of methods for
/// recovering quadrics in triangle meshes, 2002, section 3.2.
class TriangleSurface : public TrueSurface {
 public:
  /// Copies what it needs. O(n log n). Throws Error(Input) if `mesh` has no triangles.
  explicit TriangleSurface(const SurfaceMesh& mesh);

  Foot closest(const Eigen::Vector3d& p) const override;
  Foot closestFacing(const Eigen::Vector3d& p, const Eigen::Vector3d& facing) const override;
  Curvature curvature(const Eigen::Vector3d& p) const override;

  const TriangleTree& tree() const { return tree_; }

 private:
  Eigen::Vector3d normal(int triangle) const;

  TriangleTree tree_;
  std::vector<Eigen::Matrix3d> bending_;  ///< by vertex: k1 d1 d1^T + k2 d2 d2^T
};

/// All triangles of a mesh. Throws Error(Input) if it has none.
TriangleTree triangleTree(const SurfaceMesh& mesh);

}  // namespace trimquad
