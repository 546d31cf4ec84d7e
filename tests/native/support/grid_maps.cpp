#include "support/grid_maps.h"

namespace trimquad::sample {

GridMap boxesMap(const std::vector<std::array<int, 3>>& places, int n, int quads) {
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

void bend(GridMap& map, const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& place) {
  for (const auto v : map.mesh.vertices()) map.mesh.set_point(v, place(map.mesh.point(v)));
}

GridMap mapOn(const Region& region, const GridMap& map) {
  GridMap result;
  result.mesh = region.mesh;
  result.scale = map.scale;
  result.corner.resize(region.mesh.n_halfedges());
  for (const auto f : region.mesh.faces()) {
    const auto h = region.mesh.halfedge_handle(f);
    HalfedgeHandle from = map.mesh.halfedge_handle(FaceHandle(region.inputTriangle[f.idx()]));
    while (map.mesh.point(map.mesh.from_vertex_handle(from)) !=
           region.mesh.point(region.mesh.from_vertex_handle(h)))
      from = map.mesh.next_halfedge_handle(from);
    HalfedgeHandle to = h;
    for (int k = 0; k < 3; ++k) {
      result.corner[to.idx()] = map.corner[from.idx()];
      to = region.mesh.next_halfedge_handle(to);
      from = map.mesh.next_halfedge_handle(from);
    }
  }
  return result;
}

TriangleSoup soupOf(const SurfaceMesh& mesh) {
  TriangleSoup soup;
  for (const auto v : mesh.vertices()) soup.points.push_back(mesh.point(v));
  for (const auto f : mesh.faces()) {
    auto& t = soup.triangles.emplace_back();
    int k = 0;
    for (const auto v : mesh.fv_range(f)) t[k++] = v.idx();
  }
  return soup;
}

}  // namespace trimquad::sample
