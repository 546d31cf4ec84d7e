#include "trimquad/mesh/surface_mesh.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

/// The sides of triangles, by the vertex they start from, in the order of their ends.
class Sides {
 public:
  struct Side {
    int to, triangle;
    friend auto operator<=>(const Side&, const Side&) = default;
  };

  explicit Sides(const TriangleSoup& soup) : begin_(soup.points.size() + 1, 0), sides_(3 * soup.triangles.size()) {
    for (const auto& corner : soup.triangles)
      for (const int v : corner) ++begin_[v + 1];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    auto next = begin_;
    for (int t = 0; t < int(soup.triangles.size()); ++t)
      for (int k = 0; k < 3; ++k)
        sides_[next[soup.triangles[t][k]]++] = {soup.triangles[t][(k + 1) % 3], t};
    for (std::size_t v = 0; v < soup.points.size(); ++v)
      std::sort(sides_.begin() + begin_[v], sides_.begin() + begin_[v + 1]);
  }

  std::vector<Side>::const_iterator begin(int v) const { return sides_.begin() + begin_[v]; }
  std::vector<Side>::const_iterator end(int v) const { return sides_.begin() + begin_[v + 1]; }
  bool contain(int from, int to) const {
    return std::any_of(begin(from), end(from), [&](const Side& side) { return side.to == to; });
  }

 private:
  std::vector<int> begin_;  ///< by vertex, where its sides begin
  std::vector<Side> sides_;
};

}  // namespace

SurfaceMesh buildSurfaceMesh(const TriangleSoup& soup) {
  const int vertexCount = int(soup.points.size());
  for (int t = 0; t < int(soup.triangles.size()); ++t) {
    const auto& corner = soup.triangles[t];
    for (int k = 0; k < 3; ++k) {
      if (corner[k] < 0 || corner[k] >= vertexCount)
        throw inputError("tessellate", "a triangle names a vertex that does not exist", "triangle " + std::to_string(t));
      if (corner[k] == corner[(k + 1) % 3])
        throw inputError("tessellate", "a triangle names one vertex twice", "triangle " + std::to_string(t));
    }
  }
  // OpenMesh prints when it meets a non-manifold edge, so every condition is checked before it sees the triangles.
  const Sides sides(soup);
  for (int v = 0; v < vertexCount; ++v)
    for (auto side = sides.begin(v); side != sides.end(v); ++side)
      if (side != sides.begin(v) && side[-1].to == side->to)
        throw inputError("tessellate", "an edge has more than two triangles, or two that disagree in orientation",
                         "triangles " + std::to_string(side[-1].triangle) + " and " + std::to_string(side->triangle),
                         soup.points[v]);

  SurfaceMesh mesh;
  mesh.reserve(soup.points.size(), 3 * soup.triangles.size() / 2 + 3 * soup.triangles.size() / 8,
               soup.triangles.size());
  for (const auto& p : soup.points) mesh.add_vertex(p);
  // OpenMesh's add_face depends on the order of the faces around a vertex where fans are still apart; faces that it
  // cannot take yet are tried again once their neighbours are in. It keeps face numbers, so order must not change:
  // hence a vertex where two fans meet is found beforehand.
  for (int v = 0; v < vertexCount; ++v) {
    int boundaryStarts = 0;
    for (auto side = sides.begin(v); side != sides.end(v); ++side)
      if (!sides.contain(side->to, v) && ++boundaryStarts > 1)
        throw inputError("tessellate", "two sheets of triangles touch in one vertex", "vertex " + std::to_string(v),
                         soup.points[v]);
  }
  for (int t = 0; t < int(soup.triangles.size()); ++t) {
    const auto& c = soup.triangles[t];
    const VertexHandle a(c[0]), b(c[1]), d(c[2]);
    if (!mesh.add_face(a, b, d).is_valid())
      throw inputError("tessellate", "two sheets of triangles touch in one vertex", "triangle " + std::to_string(t),
                       soup.points[c[0]]);
  }
  return mesh;
}

std::vector<std::vector<HalfedgeHandle>> boundaryLoops(const SurfaceMesh& mesh) {
  std::vector<std::vector<HalfedgeHandle>> loops;
  std::vector<char> seen(mesh.n_halfedges(), 0);
  for (const auto start : mesh.halfedges()) {
    if (!mesh.is_boundary(start) || seen[start.idx()]) continue;
    auto& loop = loops.emplace_back();
    for (HalfedgeHandle h = start; !seen[h.idx()]; h = mesh.next_halfedge_handle(h)) {
      seen[h.idx()] = 1;
      loop.push_back(h);
    }
  }
  return loops;
}

int eulerCharacteristic(const SurfaceMesh& mesh) {
  return int(mesh.n_vertices()) - int(mesh.n_edges()) + int(mesh.n_faces());
}

double surfaceArea(const SurfaceMesh& mesh) {
  double area = 0;
  for (const auto f : mesh.faces()) {
    const auto h = mesh.halfedge_handle(f);
    const Eigen::Vector3d a = mesh.point(mesh.from_vertex_handle(h)), b = mesh.point(mesh.to_vertex_handle(h)),
                          c = mesh.point(mesh.to_vertex_handle(mesh.next_halfedge_handle(h)));
    area += 0.5 * (b - a).cross(c - a).norm();
  }
  return area;
}

double cornerAngle(const SurfaceMesh& mesh, HalfedgeHandle h) {
  const Eigen::Vector3d a = mesh.point(mesh.from_vertex_handle(h)), b = mesh.point(mesh.to_vertex_handle(h)),
                        c = mesh.point(mesh.to_vertex_handle(mesh.next_halfedge_handle(h)));
  const Eigen::Vector3d x = b - a, y = c - a;
  return std::atan2(x.cross(y).norm(), x.dot(y));
}

}  // namespace trimquad
