#include "support/analytic_region.h"

namespace trimquad {

void AnalyticRegion::build() {
  TriangleSoup soup;
  struct Corner {
    double u, v;
  };
  std::vector<std::array<Corner, 3>> corners;
  std::vector<int> number((columns + 1) * (rows + 1), -1);
  const auto u = [&](int i) { return firstU + (lastU - firstU) * i / columns; };
  const auto v = [&](int j) { return firstV + (lastV - firstV) * j / rows; };
  const auto vertex = [&](int i, int j) {
    const int c = closed ? i % columns : i;
    int& n = number[c + (columns + 1) * j];
    if (n < 0) {
      n = int(soup.points.size());
      soup.points.push_back(point(u(c), v(j)));
    }
    return n;
  };
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      if (!keeps(0.5 * (u(i) + u(i + 1)), 0.5 * (v(j) + v(j + 1)))) continue;
      const int a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i + 1, j + 1), d = vertex(i, j + 1);
      const Corner x[4] = {{u(i), v(j)}, {u(i + 1), v(j)}, {u(i + 1), v(j + 1)}, {u(i), v(j + 1)}};
      soup.triangles.push_back({a, b, c});
      corners.push_back({x[0], x[1], x[2]});
      soup.triangles.push_back({a, c, d});
      corners.push_back({x[0], x[2], x[3]});
    }
  region.name = "analytic";
  region.mesh = buildSurfaceMesh(soup);
  region.surface = surface;
  region.edgeCurve.resize(region.mesh.n_edges());
  region.curveParameter.assign(region.mesh.n_vertices(), 0);
  region.corner.resize(region.mesh.n_vertices());
  map.mesh = region.mesh;
  map.scale = FixedScale{30};
  map.corner.resize(map.mesh.n_halfedges());
  for (const auto f : map.mesh.faces())
    for (const auto h : map.mesh.fh_range(f))
      for (int k = 0; k < 3; ++k)
        if (soup.triangles[f.idx()][k] == map.mesh.from_vertex_handle(h).idx()) {
          // The chart at the vertex's own place, moved to this image of it, so that images differ by the
          // period.
          const Corner at = corners[f.idx()][k];
          const double turns = closed && at.u == lastU ? lastU - firstU : 0;
          const Eigen::Vector2d x = chart(at.u - turns, at.v);
          const FixedVector fixed = map.scale.round(x) + FixedVector{map.scale.round(turns), 0};
          map.corner[h.idx()] = rotated(fixed, turn);
        }
}

Eigen::Vector3d wave(double x, double y) {
  return {std::sin(x) * std::cos(y), std::cos(x) * std::cos(y), -std::sin(x) * std::sin(y)};
}

AnalyticRegion wavySheet(double first, double last, double quadsPerUnit) {
  AnalyticRegion sheet;
  sheet.columns = sheet.rows = 99;
  sheet.firstU = sheet.firstV = first;
  sheet.lastU = sheet.lastV = last;
  sheet.point = [=, middle = 0.5 * (first + last)](double u, double v) {
    const double x = (u - middle) / quadsPerUnit, y = (v - middle) / quadsPerUnit;
    return Eigen::Vector3d(x, y, wave(x, y).x());
  };
  sheet.surface = std::make_shared<GraphSurface>(wave);
  return sheet;
}

}  // namespace trimquad
