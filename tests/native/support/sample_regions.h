#pragma once

#include <cmath>
#include <functional>
#include <numbers>

#include "trimquad/mesh/region.h"

namespace trimquad::sample {

/// A region of bare triangles: surface, curves and corners are left out.
inline Region region(const TriangleSoup& soup) {
  Region r;
  r.name = "sample";
  r.mesh = buildSurfaceMesh(soup);
  r.edgeCurve.resize(r.mesh.n_edges());
  r.curveParameter.resize(r.mesh.n_vertices());
  r.corner.resize(r.mesh.n_vertices());
  return r;
}

inline TriangleSoup withoutUnusedPoints(const TriangleSoup& all) {
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

using Shape = std::function<Eigen::Vector3d(double, double)>;
using Inside = std::function<bool(double, double)>;

/// columns x rows cells over [0, 1]^2, two triangles each; cells whose centre is not inside are left out.
inline TriangleSoup sheet(int columns, int rows, const Shape& shape, const Inside& inside = {}) {
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

/// A tube: `around` x `along` cells, closed in the first parameter; shape(0, t) == shape(1, t).
inline TriangleSoup tube(int around, int along, const Shape& shape, const Inside& inside = {}) {
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

inline Eigen::Vector3d flat(double s, double t) {
  return {s, t, 0};
}
inline Eigen::Vector3d wavy(double s, double t) {
  return {6 * s - 3, 6 * t - 3, std::sin(6 * s - 3) * std::cos(6 * t - 3)};
}
inline Eigen::Vector3d cylinder(double s, double t) {
  const double a = 2 * std::numbers::pi * s;
  return {std::cos(a), std::sin(a), 3 * t};
}
/// A tube bent by a quarter turn.
inline Eigen::Vector3d elbow(double s, double t) {
  const double a = 2 * std::numbers::pi * s, b = std::numbers::pi / 2 * t, r = 4 + std::cos(a);
  return {r * std::cos(b), r * std::sin(b), -std::sin(a)};
}
/// A dome that reaches `angle` (radians) down from its top, over the square parameter domain.
inline Shape dome(double angle) {
  return [angle](double s, double t) {
    const double x = 2 * s - 1, y = 2 * t - 1, r = std::hypot(x, y), a = r * angle;
    return r == 0 ? Eigen::Vector3d(0, 0, 1)
                  : Eigen::Vector3d(std::sin(a) * x / r, std::sin(a) * y / r, std::cos(a));
  };
}

}  // namespace trimquad::sample
