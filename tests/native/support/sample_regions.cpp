#include "support/sample_regions.h"

#include <cmath>
#include <map>
#include <numbers>
#include <set>

namespace trimquad::sample {

Region region(const TriangleSoup& soup) {
  Region r;
  r.name = "sample";
  r.mesh = buildSurfaceMesh(soup);
  r.edgeCurve.resize(r.mesh.n_edges());
  r.curveParameter.resize(r.mesh.n_vertices());
  r.corner.resize(r.mesh.n_vertices());
  return r;
}

TriangleSoup withoutUnusedPoints(const TriangleSoup& all) {
  TriangleSoup soup;
  std::vector<int> number(all.points.size(), -1);
  for (auto t : all.triangles) {
    for (int& v : t) {
      if (number[v] < 0) {
        number[v] = int(soup.points.size());
        soup.points.push_back(all.points[v]);
      }
      v = number[v];
    }
    soup.triangles.push_back(t);
  }
  return soup;
}

TriangleSoup sheet(int columns, int rows, const Shape& shape, const Inside& inside) {
  TriangleSoup all;
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i) all.points.push_back(shape(double(i) / columns, double(j) / rows));
  const auto at = [&](int i, int j) { return i + (columns + 1) * j; };
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      if (inside && !inside((i + 0.5) / columns, (j + 0.5) / rows)) continue;
      const int a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
      if ((i + j) % 2 == 0) {
        all.triangles.push_back({a, b, c});
        all.triangles.push_back({a, c, d});
      } else {
        all.triangles.push_back({a, b, d});
        all.triangles.push_back({b, c, d});
      }
    }
  return withoutUnusedPoints(all);
}

TriangleSoup tube(int around, int along, const Shape& shape, const Inside& inside) {
  TriangleSoup all;
  for (int j = 0; j <= along; ++j)
    for (int i = 0; i < around; ++i) all.points.push_back(shape(double(i) / around, double(j) / along));
  const auto at = [&](int i, int j) { return i % around + around * j; };
  for (int j = 0; j < along; ++j)
    for (int i = 0; i < around; ++i) {
      if (inside && !inside((i + 0.5) / around, (j + 0.5) / along)) continue;
      const int a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
      all.triangles.push_back({a, b, c});
      all.triangles.push_back({a, c, d});
    }
  return withoutUnusedPoints(all);
}

Eigen::Vector3d flat(double s, double t) {
  return {s, t, 0};
}

Eigen::Vector3d wavy(double s, double t) {
  return {6 * s - 3, 6 * t - 3, std::sin(6 * s - 3) * std::cos(6 * t - 3)};
}

Eigen::Vector3d cylinder(double s, double t) {
  const double a = 2 * std::numbers::pi * s;
  return {std::cos(a), std::sin(a), 3 * t};
}

Eigen::Vector3d elbow(double s, double t) {
  const double a = 2 * std::numbers::pi * s, b = std::numbers::pi / 2 * t, r = 4 + std::cos(a);
  return {r * std::cos(b), r * std::sin(b), -std::sin(a)};
}

Shape dome(double angle) {
  return [angle](double s, double t) {
    const double x = 2 * s - 1, y = 2 * t - 1, r = std::hypot(x, y), a = r * angle;
    return r == 0 ? Eigen::Vector3d(0, 0, 1)
                  : Eigen::Vector3d(std::sin(a) * x / r, std::sin(a) * y / r, std::cos(a));
  };
}

TriangleSoup torus(int columns, int rows, double radius) {
  TriangleSoup soup;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const double a = 2 * std::numbers::pi * i / columns, b = 2 * std::numbers::pi * j / rows,
                   r = radius + std::cos(a);
      soup.points.emplace_back(r * std::cos(b), r * std::sin(b), -std::sin(a));
    }
  const auto at = [&](int i, int j) { return i % columns + columns * (j % rows); };
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      soup.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      soup.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return soup;
}

TriangleSoup boxes(const std::vector<std::array<int, 3>>& places, int n) {
  const std::set<std::array<int, 3>> filled(places.begin(), places.end());
  std::map<std::array<int, 3>, int> number;
  TriangleSoup soup;
  const auto point = [&](std::array<int, 3> p) {
    const auto [it, isNew] = number.emplace(p, int(soup.points.size()));
    if (isNew) soup.points.push_back(Eigen::Vector3d(p[0], p[1], p[2]) / n);
    return it->second;
  };
  for (const auto& box : filled)
    for (int axis = 0; axis < 3; ++axis)
      for (const int side : {0, 1}) {
        auto neighbour = box;
        neighbour[axis] += side ? 1 : -1;
        if (filled.count(neighbour)) continue;
        const int b = (axis + 1) % 3, c = (axis + 2) % 3;
        for (int i = 0; i < n; ++i)
          for (int j = 0; j < n; ++j) {
            const auto at = [&](int di, int dj) {
              std::array<int, 3> p;
              p[axis] = n * (box[axis] + side);
              p[b] = n * box[b] + i + di;
              p[c] = n * box[c] + j + dj;
              return point(p);
            };
            std::array<int, 4> q{at(0, 0), at(1, 0), at(1, 1), at(0, 1)};
            if (!side) std::swap(q[1], q[3]);
            soup.triangles.push_back({q[0], q[1], q[2]});
            soup.triangles.push_back({q[0], q[2], q[3]});
          }
      }
  return soup;
}

TriangleSoup sphere(int n) {
  TriangleSoup soup = boxes({{0, 0, 0}}, n);
  for (auto& p : soup.points) p = (p - Eigen::Vector3d::Constant(0.5)).normalized();
  return soup;
}

}  // namespace trimquad::sample
