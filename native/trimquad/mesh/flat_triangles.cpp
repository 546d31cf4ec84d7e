#include "trimquad/mesh/flat_triangles.h"

#include <algorithm>
#include <limits>
#include <string>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

using Eigen::Vector3d;

/// Smallest height relative to the longest side at which a triangle still has an area.
constexpr double kFlat = 1e-8;
/// A flat triangle whose shortest side is under this share of its longest one is a needle, otherwise a cap.
constexpr double kNeedle = 1e-6;

/// Smallest height over longest side; 0 if all corners coincide.
double flatness(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  return longest > 0 ? (b - a).cross(c - a).norm() / longest : 0;
}

Vector3d areaNormal(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  return (b - a).cross(c - a);
}

class FlatTriangles {
 public:
  explicit FlatTriangles(SurfaceMesh& mesh) : mesh_(mesh) {}

  bool isFlat(FaceHandle f) const { return flatness(f) < kFlat; }

  bool resolve(FaceHandle f) {
    HalfedgeHandle longest = mesh_.halfedge_handle(f), shortest = longest;
    for (const auto h : mesh_.fh_range(f)) {
      if (length(h) > length(longest)) longest = h;
      if (length(h) < length(shortest)) shortest = h;
    }
    if (length(shortest) < kNeedle * length(longest))
      return collapse(shortest) || collapse(mesh_.opposite_halfedge_handle(shortest));
    return mesh_.is_boundary(mesh_.edge_handle(longest)) ? dropAtBoundary(longest) : flip(longest);
  }

 private:
  Vector3d from(HalfedgeHandle h) const { return mesh_.point(mesh_.from_vertex_handle(h)); }
  Vector3d to(HalfedgeHandle h) const { return mesh_.point(mesh_.to_vertex_handle(h)); }
  Vector3d apex(HalfedgeHandle h) const { return to(mesh_.next_halfedge_handle(h)); }
  double length(HalfedgeHandle h) const { return (to(h) - from(h)).norm(); }
  double flatness(FaceHandle f) const {
    const auto h = mesh_.halfedge_handle(f);
    return trimquad::flatness(from(h), to(h), apex(h));
  }

  /// The flat triangle at `h` and its neighbour there exchange their diagonal, if the flatter one of the two
  /// gains.
  bool flip(HalfedgeHandle h) {
    const auto o = mesh_.opposite_halfedge_handle(h);
    if (!mesh_.is_flip_ok(mesh_.edge_handle(h))) return false;
    const Vector3d a = from(h), b = to(h), c = apex(h), d = apex(o);
    const double before = std::min(trimquad::flatness(a, b, c), trimquad::flatness(b, a, d));
    const double after = std::min(trimquad::flatness(c, a, d), trimquad::flatness(d, b, c));
    if (!(after > before)) return false;
    const Vector3d normal = areaNormal(b, a, d);
    if (trimquad::flatness(b, a, d) >= kFlat &&
        (areaNormal(c, a, d).dot(normal) <= 0 || areaNormal(d, b, c).dot(normal) <= 0))
      return false;
    mesh_.flip(mesh_.edge_handle(h));
    return true;
  }

  /// The boundary runs through the apex instead, which lies on it already.
  bool dropAtBoundary(HalfedgeHandle longest) {
    if (mesh_.is_boundary(mesh_.to_vertex_handle(mesh_.next_halfedge_handle(longest)))) return false;
    mesh_.delete_face(mesh_.face_handle(longest), false);
    return true;
  }

  /// Moves the vertex that `h` leaves onto the other one.
  bool collapse(HalfedgeHandle h) {
    const VertexHandle moved = mesh_.from_vertex_handle(h);
    if (mesh_.is_boundary(moved) && !mesh_.is_boundary(mesh_.edge_handle(h))) return false;
    if (!mesh_.is_collapse_ok(h)) return false;
    const FaceHandle gone1 = mesh_.face_handle(h),
                     gone2 = mesh_.face_handle(mesh_.opposite_halfedge_handle(h));
    const Vector3d target = to(h);
    for (const auto o : mesh_.voh_range(moved)) {
      const FaceHandle f = mesh_.face_handle(o);
      if (!f.is_valid() || f == gone1 || f == gone2 || isFlat(f)) continue;
      const Vector3d b = to(o), c = apex(o);
      if (trimquad::flatness(target, b, c) < kFlat ||
          areaNormal(target, b, c).dot(areaNormal(from(o), b, c)) <= 0)
        return false;
    }
    mesh_.collapse(h);
    return true;
  }

  SurfaceMesh& mesh_;
};

/// The alive part of `mesh`; vertices and triangles stay in order.
void readBack(const SurfaceMesh& mesh, TriangleSoup& soup, std::vector<int>& triangle) {
  std::vector<int> number(mesh.n_vertices(), -1);
  std::vector<char> used(mesh.n_vertices(), 0);
  for (const auto f : mesh.faces())  // skips deleted faces
    for (const auto v : mesh.fv_range(f)) used[v.idx()] = 1;
  soup = {};
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (!used[v]) continue;
    number[v] = int(soup.points.size());
    soup.points.push_back(mesh.point(VertexHandle(int(v))));
  }
  std::vector<int> origin;
  for (const auto f : mesh.faces()) {
    auto& corners = soup.triangles.emplace_back();
    int k = 0;
    for (const auto v : mesh.fv_range(f)) corners[k++] = number[v.idx()];
    origin.push_back(triangle[f.idx()]);
  }
  triangle = std::move(origin);
}

}  // namespace

int resolveFlatTriangles(TriangleSoup& soup, std::vector<int>& triangle) {
  std::vector<FaceHandle> flat;
  for (int t = 0; t < int(soup.triangles.size()); ++t) {
    const auto& c = soup.triangles[t];
    if (flatness(soup.points[c[0]], soup.points[c[1]], soup.points[c[2]]) < kFlat) flat.emplace_back(t);
  }
  if (flat.empty()) return 0;
  const int found = int(flat.size());
  SurfaceMesh mesh = buildSurfaceMesh(soup);
  FlatTriangles triangles(mesh);
  const auto stillFlat = [&] {
    std::vector<FaceHandle> left;
    for (const auto f : mesh.faces())
      if (triangles.isFlat(f)) left.push_back(f);
    return left;
  };
  // Flips gain in flatness and the other steps lose a triangle, so no state comes twice; passes end without a
  // step.
  for (bool stepped = true; stepped && !flat.empty();) {
    stepped = false;
    for (const FaceHandle f : flat)
      if (!mesh.status(f).deleted() && triangles.isFlat(f)) stepped |= triangles.resolve(f);
    flat = stillFlat();
  }
  if (!flat.empty()) {
    const FaceHandle f = flat.front();
    throw inputError(
        "tessellate",
        std::to_string(flat.size()) + " triangles have no area and no safe repair; remesh the surface there",
        "triangle " + std::to_string(triangle[f.idx()]), mesh.point(*mesh.cfv_iter(f)));
  }
  readBack(mesh, soup, triangle);
  return found;
}

}  // namespace trimquad
