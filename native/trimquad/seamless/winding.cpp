#include "trimquad/seamless/winding.h"

#include <cmath>

namespace trimquad {

std::vector<VertexHandle> wrongCones(const SurfaceMesh& mesh, const std::vector<int>& index,
                                     const SeamBasis& basis, const Eigen::VectorXd& x) {
  const auto image = [&](HalfedgeHandle h) {
    return Eigen::Vector2d(x[basis.coordinate(basis.wedge(h), 0)], x[basis.coordinate(basis.wedge(h), 1)]);
  };
  std::vector<VertexHandle> wrong;
  for (const auto v : mesh.vertices()) {
    if (mesh.is_boundary(v)) continue;
    double angle = 0;
    for (const auto h : mesh.voh_range(v)) {
      const Eigen::Vector2d a = image(mesh.next_halfedge_handle(h)) - image(h),
                            b = image(mesh.prev_halfedge_handle(h)) - image(h);
      angle += std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
    }
    if (std::lround(angle / (M_PI / 2)) != 4 - index[v.idx()]) wrong.push_back(v);
  }
  return wrong;
}

std::vector<VertexHandle> troubled(const SurfaceMesh& mesh, const std::vector<int>& index,
                                   const SeamBasis& basis, const MapEnergy& energy,
                                   const Eigen::VectorXd& x) {
  auto vertices = wrongCones(mesh, index, basis, x);
  for (const auto f : mesh.faces())
    if (!(energy.jacobian(f.idx(), x).det() > 0))
      for (const auto v : mesh.fv_range(f)) vertices.push_back(v);
  return vertices;
}

std::vector<FaceHandle> wrongTriangles(const SurfaceMesh& mesh, const std::vector<int>& index,
                                       const SeamBasis& basis, const MapEnergy& energy,
                                       const Eigen::VectorXd& x) {
  std::vector<char> wrong(mesh.n_faces(), 0);
  constexpr double kCollapsed = 1e-9;  // relative to |J|^2
  for (const auto f : mesh.faces()) {
    const auto jacobian = energy.jacobian(f.idx(), x);
    wrong[f.idx()] = !(jacobian.det() > kCollapsed * jacobian.norm2());
  }
  for (const auto v : wrongCones(mesh, index, basis, x))
    for (const auto f : mesh.vf_range(v)) wrong[f.idx()] = 1;
  std::vector<FaceHandle> triangles;
  for (const auto f : mesh.faces())
    if (wrong[f.idx()]) triangles.push_back(f);
  return triangles;
}

}  // namespace trimquad
