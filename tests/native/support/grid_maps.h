#pragma once

#include <map>

#include "support/sample_regions.h"
#include "trimquad/gridmap/grid_map.h"
#include "trimquad/mesh/mesh_model.h"

namespace trimquad::sample {

/// The surface of unit boxes (see `boxes`) with n x n triangulated squares a side, and its grid map with
/// `quads` quads along the side of a box: every triangle in a chart of its own side.
inline GridMap boxesMap(const std::vector<std::array<int, 3>>& places, int n, int quads) {
  GridMap map;
  map.mesh = buildSurfaceMesh(boxes(places, n));
  map.scale = FixedScale{30};
  map.corner.resize(map.mesh.n_halfedges());
  for (const auto f : map.mesh.faces()) {
    std::array<Eigen::Vector3d, 3> p;
    std::array<HalfedgeHandle, 3> h;
    h[0] = map.mesh.halfedge_handle(f);
    for (int k = 0; k < 3; ++k) {
      if (k > 0) h[k] = map.mesh.next_halfedge_handle(h[k - 1]);
      p[k] = map.mesh.point(map.mesh.from_vertex_handle(h[k]));
    }
    const Eigen::Vector3d normal = (p[1] - p[0]).cross(p[2] - p[0]);
    int axis;
    normal.cwiseAbs().maxCoeff(&axis);
    const int b = (axis + 1) % 3, c = (axis + 2) % 3, sign = normal[axis] > 0 ? 1 : -1;
    for (int k = 0; k < 3; ++k)
      map.corner[h[k].idx()] = map.scale.round(Eigen::Vector2d(quads * p[k][b] * sign, quads * p[k][c]));
  }
  return map;
}

/// The same map on a surface of another shape.
inline void bend(GridMap& map, const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& place) {
  for (const auto v : map.mesh.vertices()) map.mesh.set_point(v, place(map.mesh.point(v)));
}

/// A mesh model of one region with a given map: the map's mesh as the input.
inline Model modelOf(const SurfaceMesh& mesh) {
  TriangleSoup soup;
  for (const auto v : mesh.vertices()) soup.points.push_back(mesh.point(v));
  for (const auto f : mesh.faces()) {
    std::array<int, 3> t;
    int k = 0;
    for (const auto v : mesh.fv_range(f)) t[k++] = v.idx();
    soup.triangles.push_back(t);
  }
  MeshModelOptions options;
  return meshModel(soup, options, Progress());
}

}  // namespace trimquad::sample
