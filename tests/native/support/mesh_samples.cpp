#include "support/mesh_samples.h"

namespace trimquad {

TriangleSoup sheet(int columns, int rows, const std::function<Eigen::Vector3d(double, double)>& surface) {
  TriangleSoup soup;
  for (int i = 0; i <= columns; ++i)
    for (int j = 0; j <= rows; ++j) soup.points.push_back(surface(i, j));
  for (int i = 0; i < columns; ++i)
    for (int j = 0; j < rows; ++j) {
      const int a = i * (rows + 1) + j, b = a + rows + 1;
      soup.triangles.push_back({a, b, b + 1});
      soup.triangles.push_back({a, b + 1, a + 1});
    }
  return soup;
}

TriangleSoup flatSheet(int columns, int rows) {
  return sheet(columns, rows, [](double x, double y) { return Eigen::Vector3d(x, y, 0); });
}

TriangleSoup cube() {
  TriangleSoup soup;
  for (int i = 0; i < 8; ++i) soup.points.emplace_back(i & 1, i >> 1 & 1, i >> 2);
  for (const auto& q :
       {std::array{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
    soup.triangles.push_back({q[0], q[1], q[2]});
    soup.triangles.push_back({q[0], q[2], q[3]});
  }
  return soup;
}

TriangleSoup band(int n, int halfTwists) {
  TriangleSoup soup;
  for (int i = 0; i < n; ++i) {
    const double a = 2 * kPi * i / n, b = a * halfTwists / 2;
    for (const double s : {-0.3, 0.3})
      soup.points.emplace_back((1 + s * std::cos(b)) * std::cos(a), (1 + s * std::cos(b)) * std::sin(a),
                               s * std::sin(b));
  }
  for (int i = 0; i < n; ++i) {
    const bool crossed = i == n - 1 && halfTwists % 2 != 0;
    const int a = 2 * i, b = a + 1, c = (2 * i + 2) % (2 * n) + (crossed ? 1 : 0),
              d = (2 * i + 2) % (2 * n) + (crossed ? 0 : 1);
    soup.triangles.push_back({a, c, d});
    soup.triangles.push_back({a, d, b});
  }
  return soup;
}

TriangleSoup sphere(double r, int subdivisions) {
  TriangleSoup soup = cube();
  for (auto& p : soup.points) p -= Eigen::Vector3d::Constant(0.5);
  for (int s = 0; s < subdivisions; ++s) {
    TriangleSoup finer;
    finer.points = soup.points;
    std::map<std::pair<int, int>, int> middle;
    const auto between = [&](int a, int b) {
      const auto [it, isNew] = middle.try_emplace(std::minmax(a, b), int(finer.points.size()));
      if (isNew) finer.points.push_back(0.5 * (soup.points[a] + soup.points[b]));
      return it->second;
    };
    for (const auto& [a, b, c] : soup.triangles) {
      const int ab = between(a, b), bc = between(b, c), ca = between(c, a);
      finer.triangles.insert(finer.triangles.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    soup = std::move(finer);
  }
  for (auto& p : soup.points) p *= r / p.norm();
  return soup;
}

TriangleSoup exploded(const TriangleSoup& soup) {
  TriangleSoup result;
  for (const auto& t : soup.triangles) {
    const int n = int(result.points.size());
    for (const int v : t) result.points.push_back(soup.points[v]);
    result.triangles.push_back({n, n + 1, n + 2});
  }
  return result;
}

double enclosedVolume(const TriangleSoup& soup) {
  double volume = 0;
  for (const auto& [a, b, c] : soup.triangles)
    volume += soup.points[a].dot(soup.points[b].cross(soup.points[c])) / 6;
  return volume;
}

}  // namespace trimquad
