#include "trimquad/mesh/triangle_surface.h"

#include <Eigen/Dense>
#include <algorithm>

namespace trimquad {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// Weight of "as flat as possible" in the fit, relative to the data: decides only what the points leave open.
constexpr double kRidge = 1e-9;
/// The five coefficients of a quadric through the vertex need as many neighbours.
constexpr std::size_t kFewestNeighbours = 6;
constexpr int kMostRings = 4;

std::vector<std::array<int, 3>> triangles(const SurfaceMesh& mesh) {
  std::vector<std::array<int, 3>> result;
  for (const auto f : mesh.faces()) {
    const auto h = mesh.halfedge_handle(f);
    result.push_back({mesh.from_vertex_handle(h).idx(), mesh.to_vertex_handle(h).idx(),
                      mesh.to_vertex_handle(mesh.next_halfedge_handle(h)).idx()});
  }
  return result;
}

std::vector<Vector3d> positions(const SurfaceMesh& mesh) {
  std::vector<Vector3d> result;
  for (const auto v : mesh.vertices()) result.push_back(mesh.point(v));
  return result;
}

/// Area-weighted unit normal; zero if the areas around `v` cancel.
Vector3d vertexNormal(const SurfaceMesh& mesh, VertexHandle v) {
  Vector3d sum = Vector3d::Zero();
  for (const auto h : mesh.voh_range(v)) {
    if (mesh.is_boundary(h)) continue;
    const Vector3d a = mesh.point(v), b = mesh.point(mesh.to_vertex_handle(h)),
                   c = mesh.point(mesh.to_vertex_handle(mesh.next_halfedge_handle(h)));
    sum += (b - a).cross(c - a);
  }
  return sum.norm() > 0 ? Vector3d(sum.normalized()) : Vector3d(Vector3d::Zero());
}

/// The vertices within two edges of a vertex; more where these are too few for a fit.
class Neighbourhood {
 public:
  explicit Neighbourhood(const SurfaceMesh& mesh) : mesh_(mesh), visit_(mesh.n_vertices(), -1) {}

  const std::vector<VertexHandle>& around(VertexHandle center) {
    found_.assign(1, center);
    visit_[center.idx()] = center.idx();
    std::size_t ringBegin = 0;
    for (int ring = 0; ring < kMostRings && (ring < 2 || found_.size() <= kFewestNeighbours); ++ring) {
      const std::size_t ringEnd = found_.size();
      for (std::size_t i = ringBegin; i < ringEnd; ++i)
        for (const auto v : mesh_.vv_range(found_[i])) {
          if (visit_[v.idx()] == center.idx()) continue;
          visit_[v.idx()] = center.idx();
          found_.push_back(v);
        }
      ringBegin = ringEnd;
    }
    return found_;
  }

 private:
  const SurfaceMesh& mesh_;
  std::vector<int> visit_;  ///< by vertex: for which center it was found last
  std::vector<VertexHandle> found_;
};

/// z = a x^2 + b x y + c y^2 + d x + e y over the tangent plane, in units of the neighbourhood's radius.
Matrix3d bendingAt(const SurfaceMesh& mesh, VertexHandle center,
                   const std::vector<VertexHandle>& neighbours) {
  const Vector3d n = vertexNormal(mesh, center), origin = mesh.point(center);
  double radius = 0;
  for (const auto v : neighbours) radius = std::max(radius, (mesh.point(v) - origin).norm());
  if (n.isZero() || radius == 0) return Matrix3d::Zero();
  const Vector3d u = n.unitOrthogonal(), w = n.cross(u);

  using Vector5d = Eigen::Matrix<double, 5, 1>;
  Eigen::Matrix<double, 5, 5> normalMatrix = Eigen::Matrix<double, 5, 5>::Zero();
  Vector5d right = Vector5d::Zero();
  for (const auto v : neighbours) {
    const Vector3d d = (mesh.point(v) - origin) / radius;
    const double x = d.dot(u), y = d.dot(w), z = d.dot(n);
    const Vector5d row(x * x, x * y, y * y, x, y);
    normalMatrix += row * row.transpose();
    right += z * row;
  }
  normalMatrix.diagonal().array() += kRidge * normalMatrix.trace();
  const Vector5d q = normalMatrix.ldlt().solve(right);

  const Vector3d tx = u + q[3] * n, ty = w + q[4] * n;
  Matrix2d first;
  first << tx.dot(tx), tx.dot(ty), tx.dot(ty), ty.dot(ty);
  Matrix2d second;
  second << 2 * q[0], q[1], q[1], 2 * q[2];
  second /= std::sqrt(1 + q[3] * q[3] + q[4] * q[4]) * radius;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix2d> principal(second, first);
  Matrix3d bending = Matrix3d::Zero();
  for (int k = 0; k < 2; ++k) {
    const Vector2d c = principal.eigenvectors().col(k);
    const Vector3d direction = (c[0] * tx + c[1] * ty).normalized();
    bending += principal.eigenvalues()[k] * direction * direction.transpose();
  }
  return bending;
}

}  // namespace

TriangleTree triangleTree(const SurfaceMesh& mesh) {
  return {positions(mesh), triangles(mesh)};
}

TriangleSurface::TriangleSurface(const SurfaceMesh& mesh) : tree_(triangleTree(mesh)) {
  bending_.reserve(mesh.n_vertices());
  Neighbourhood neighbourhood(mesh);
  for (const auto v : mesh.vertices()) bending_.push_back(bendingAt(mesh, v, neighbourhood.around(v)));
}

Vector3d TriangleSurface::normal(int triangle) const {
  const auto& t = tree_.triangles()[triangle];
  const auto& p = tree_.points();
  return (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]).normalized();
}

TrueSurface::Foot TriangleSurface::closest(const Vector3d& p) const {
  const TriangleTree::Hit hit = tree_.closest(p);
  return {hit.point, normal(hit.triangle)};
}

TrueSurface::Foot TriangleSurface::closestFacing(const Vector3d& p, const Vector3d& facing) const {
  const auto hit = tree_.closestFacing(p, facing);
  return hit ? Foot{hit->point, normal(hit->triangle)} : closest(p);
}

TrueSurface::Curvature TriangleSurface::curvature(const Vector3d& p) const {
  const TriangleTree::Hit hit = tree_.closest(p);
  const auto& t = tree_.triangles()[hit.triangle];
  Matrix3d bending = Matrix3d::Zero();
  for (int k = 0; k < 3; ++k) bending += hit.barycentric[k] * bending_[t[k]];
  const Vector3d n = normal(hit.triangle), u = n.unitOrthogonal(), w = n.cross(u);
  Eigen::Matrix<double, 3, 2> frame;
  frame << u, w;
  const Eigen::SelfAdjointEigenSolver<Matrix2d> principal(frame.transpose() * bending * frame);
  Curvature result;
  result.k1 = principal.eigenvalues()[1];
  result.k2 = principal.eigenvalues()[0];
  result.direction1 = frame * principal.eigenvectors().col(1);
  result.direction2 = frame * principal.eigenvectors().col(0);
  return result;
}

}  // namespace trimquad
