#include "trimquad/mesh/surface_mesh.h"

#include <cmath>

#include "trimquad/base/error.h"

namespace trimquad {

SurfaceMesh buildSurfaceMesh(const TriangleSoup& soup) {
  const int vertexCount = int(soup.points.size());
  // OpenMesh prints when it meets a non-manifold edge, so every condition is checked before it sees the triangles.
  std::vector<std::array<int, 3>> sides;  // from, to, triangle
  sides.reserve(3 * soup.triangles.size());
  for (int t = 0; t < int(soup.triangles.size()); ++t) {
    const auto& corner = soup.triangles[t];
    for (int k = 0; k < 3; ++k) {
      if (corner[k] < 0 || corner[k] >= vertexCount)
        throw inputError("tessellate", "a triangle names a vertex that does not exist", "triangle " + std::to_string(t));
      if (corner[k] == corner[(k + 1) % 3])
        throw inputError("tessellate", "a triangle names one vertex twice", "triangle " + std::to_string(t));
      sides.push_back({corner[k], corner[(k + 1) % 3], t});
    }
  }
  std::sort(sides.begin(), sides.end());
  for (size_t i = 1; i < sides.size(); ++i)
    if (sides[i][0] == sides[i - 1][0] && sides[i][1] == sides[i - 1][1])
      throw inputError("tessellate", "an edge has more than two triangles, or two that disagree in orientation",
                       "triangles " + std::to_string(sides[i - 1][2]) + " and " + std::to_string(sides[i][2]),
                       soup.points[sides[i][0]]);

  SurfaceMesh mesh;
  mesh.reserve(soup.points.size(), sides.size() / 2 + sides.size() / 8, soup.triangles.size());
  for (const auto& p : soup.points) mesh.add_vertex(p);
  // OpenMesh's add_face depends on the order of the faces around a vertex where fans are still apart; faces that it
  // cannot take yet are tried again once their neighbours are in. It keeps face numbers, so order must not change:
  // hence a vertex where two fans meet is found beforehand.
  std::vector<int> fanSides(vertexCount, 0), boundaryStarts(vertexCount, 0);
  const auto present = [&](int a, int b) {
    const auto it = std::lower_bound(sides.begin(), sides.end(), std::array<int, 3>{a, b, -1});
    return it != sides.end() && (*it)[0] == a && (*it)[1] == b;
  };
  for (const auto& s : sides)
    if (!present(s[1], s[0]) && ++boundaryStarts[s[0]] > 1)
      throw inputError("tessellate", "two sheets of triangles touch in one vertex", "vertex " + std::to_string(s[0]),
                       soup.points[s[0]]);
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
