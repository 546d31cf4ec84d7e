#include "trimquad/mesh/split_triangles.h"

#include <algorithm>
#include <limits>

namespace trimquad {
namespace {

using Eigen::Vector3d;

constexpr double kSamePlace = 1e-6;  ///< barycentric
/// A new vertex lies on the true surface if that leaves this share of the smallest area that the middle would
/// give.
constexpr double kLeastPart = 0.3;

/// The smallest area, as seen along `normal`, of the triangles between `point` and a ring around it.
double smallestPart(const Vector3d& point, const Vector3d& normal, const std::vector<Vector3d>& ring) {
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vector3d &a = ring[i], &b = ring[(i + 1) % ring.size()];
    smallest = std::min(smallest, (a - point).cross(b - point).dot(normal));
  }
  return smallest;
}

bool hasCorner(const SurfaceMesh& mesh, FaceHandle f, VertexHandle v) {
  for (const auto corner : mesh.fv_range(f))
    if (corner == v) return true;
  return false;
}

class ConstraintSplit {
 public:
  explicit ConstraintSplit(Region& region)
      : region_(region), held_(region.mesh.n_vertices(), false), aligned_(region.mesh.n_edges(), false) {
    for (const auto e : region.aligned) {
      aligned_[e.idx()] = true;
      for (const int side : {0, 1}) hold(region.mesh.to_vertex_handle(region.mesh.halfedge_handle(e, side)));
    }
    for (const auto v : region.featurePoints) hold(v);
  }

  void run() {
    auto& mesh = region_.mesh;
    std::vector<EdgeHandle> between;
    for (const auto e : mesh.edges()) {
      const auto h = mesh.halfedge_handle(e, 0);
      if (!aligned_[e.idx()] && !mesh.is_boundary(e) && held(mesh.from_vertex_handle(h)) &&
          held(mesh.to_vertex_handle(h)))
        between.push_back(e);
    }
    for (const auto e : between) {
      const auto h = mesh.halfedge_handle(e, 0);
      const VertexHandle a = mesh.from_vertex_handle(h), b = mesh.to_vertex_handle(h);
      const auto apex = [&](HalfedgeHandle side) {
        return mesh.point(mesh.to_vertex_handle(mesh.next_halfedge_handle(side)));
      };
      const Vector3d normal =
          mesh.calc_face_normal(mesh.face_handle(h)) + mesh.calc_face_normal(mesh.opposite_face_handle(h));
      const std::vector<Vector3d> ring{mesh.point(a), apex(mesh.opposite_halfedge_handle(h)), mesh.point(b),
                                       apex(h)};
      const VertexHandle v = addVertex(0.5 * (mesh.point(a) + mesh.point(b)), normal, ring);
      splitEdge(mesh, e, v, region_.inputTriangle);
    }
    std::vector<FaceHandle> enclosed;
    for (const auto f : mesh.faces()) {
      bool all = true;
      for (const auto v : mesh.fv_range(f)) all = all && held(v);
      if (all) enclosed.push_back(f);
    }
    for (const auto f : enclosed) {
      std::vector<Vector3d> ring;
      for (const auto v : mesh.fv_range(f)) ring.push_back(mesh.point(v));
      const VertexHandle v = addVertex(mesh.calc_face_centroid(f), mesh.calc_face_normal(f), ring);
      splitFace(mesh, f, v, region_.inputTriangle);
    }
    region_.edgeCurve.resize(mesh.n_edges());
  }

 private:
  void hold(VertexHandle v) { held_[v.idx()] = true; }
  bool held(VertexHandle v) const { return held_[v.idx()]; }

  /// \param ring  the corners of the triangles that meet at the new vertex, counter-clockwise
  VertexHandle addVertex(Vector3d point, const Vector3d& normal, const std::vector<Vector3d>& ring) {
    if (region_.surface) {
      const auto foot = region_.surface->closestFacing(point, normal);
      const double kept = smallestPart(foot.point, normal, ring) / smallestPart(point, normal, ring);
      if (foot.normal.dot(normal) > 0 && kept >= kLeastPart) point = foot.point;
    }
    held_.push_back(false);
    region_.curveParameter.push_back(0);
    region_.corner.emplace_back();
    return region_.mesh.add_vertex(point);
  }

  Region& region_;
  std::vector<bool> held_;     ///< by vertex
  std::vector<bool> aligned_;  ///< by edge
};

}  // namespace

void splitEdge(SurfaceMesh& mesh, EdgeHandle e, VertexHandle v, std::vector<int>& origin) {
  const auto before = mesh.n_faces();
  const auto h = mesh.halfedge_handle(e, 0), o = mesh.halfedge_handle(e, 1);
  const FaceHandle parents[] = {mesh.face_handle(h), mesh.face_handle(o)};
  VertexHandle apex;
  if (parents[0].is_valid()) apex = mesh.to_vertex_handle(mesh.next_halfedge_handle(h));
  mesh.split(e, v);
  if (origin.empty()) return;
  for (auto f = before; f < mesh.n_faces(); ++f) {
    const bool first = apex.is_valid() && hasCorner(mesh, FaceHandle(int(f)), apex);
    origin.push_back(origin[parents[first ? 0 : 1].idx()]);
  }
}

void splitFace(SurfaceMesh& mesh, FaceHandle f, VertexHandle v, std::vector<int>& origin) {
  mesh.split(f, v);
  if (!origin.empty()) origin.resize(mesh.n_faces(), origin[f.idx()]);
}

VertexHandle insertPoint(SurfaceMesh& mesh, FaceHandle f, const Vector3d& barycentric,
                         std::vector<int>& origin) {
  std::array<HalfedgeHandle, 3> side;  // side k leaves corner k
  side[0] = mesh.halfedge_handle(f);
  for (const int k : {1, 2}) side[k] = mesh.next_halfedge_handle(side[k - 1]);
  Vector3d point = Vector3d::Zero();
  for (int k = 0; k < 3; ++k) {
    if (barycentric[k] >= 1 - kSamePlace) return mesh.from_vertex_handle(side[k]);
    point += barycentric[k] * mesh.point(mesh.from_vertex_handle(side[k]));
  }
  const VertexHandle v = mesh.add_vertex(point);
  for (int k = 0; k < 3; ++k)
    if (barycentric[(k + 2) % 3] <= kSamePlace) {
      splitEdge(mesh, mesh.edge_handle(side[k]), v, origin);
      return v;
    }
  splitFace(mesh, f, v, origin);
  return v;
}

void splitConstrainedTriangles(Region& region) {
  if (region.aligned.empty() && region.featurePoints.empty()) return;
  ConstraintSplit(region).run();
}

}  // namespace trimquad
