#include "support/sample_maps.h"

namespace trimquad::samples {

GridMap gridMapOf(const MappedSoup& mapped, int bits) {
  GridMap map;
  map.mesh = buildSurfaceMesh(mapped.soup);
  map.scale.bits = bits;
  map.corner.resize(map.mesh.n_halfedges());
  for (const auto f : map.mesh.faces())
    for (const auto h : map.mesh.fh_range(f))
      for (int k = 0; k < 3; ++k)
        if (mapped.soup.triangles[f.idx()][k] == map.mesh.from_vertex_handle(h).idx())
          map.corner[h.idx()] = map.scale.round(mapped.corners[f.idx()][k]);
  return map;
}

GridMap planarMap(const TriangleSoup& soup, int bits) {
  MappedSoup mapped{soup, {}};
  for (const auto& t : soup.triangles)
    mapped.corners.push_back(
        {soup.points[t[0]].head<2>(), soup.points[t[1]].head<2>(), soup.points[t[2]].head<2>()});
  return gridMapOf(mapped, bits);
}

TriangleSoup sheet(int columns, int rows, const std::function<Eigen::Vector2d(int, int)>& place,
                   const std::function<bool(int, int)>& leaveOut) {
  TriangleSoup soup;
  std::vector<int> number((columns + 1) * (rows + 1), -1);
  const auto vertex = [&](int i, int j) {
    int& n = number[j * (columns + 1) + i];
    if (n < 0) {
      n = int(soup.points.size());
      const Eigen::Vector2d p = place(i, j);
      soup.points.push_back({p.x(), p.y(), 0});
    }
    return n;
  };
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      if (leaveOut(i, j)) continue;
      const int a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i + 1, j + 1), d = vertex(i, j + 1);
      soup.triangles.push_back({a, b, c});
      soup.triangles.push_back({a, c, d});
    }
  return soup;
}

MappedSoup cone(int quarters, int n, double width, int inner, Eigen::Vector2d apex) {
  MappedSoup mapped;
  std::vector<int> number(size_t(quarters) * (n + 1) * (n + 1), -1);
  const auto vertex = [&](int q, int i, int j) {
    if (i == 0 && j == 0) q = 0;
    if (i == 0 && j > 0) q = (q + 1) % quarters, i = j, j = 0;  // the next square's first side
    int& index = number[(size_t(q) * (n + 1) + j) * (n + 1) + i];
    if (index < 0) {
      index = int(mapped.soup.points.size());
      const double angle = (q + std::atan2(double(j), double(i)) / (M_PI / 2)) * 2 * M_PI / quarters;
      const double radius = std::hypot(i, j) * width / n;
      mapped.soup.points.push_back({radius * std::cos(angle), radius * std::sin(angle),
                                    quarters > 4 ? std::cos(2 * angle) * radius : 0});
    }
    return index;
  };
  const auto at = [&](int i, int j) -> Eigen::Vector2d { return apex + Eigen::Vector2d(i, j) * (width / n); };
  for (int q = 0; q < quarters; ++q)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        if (i < inner && j < inner) continue;
        const int a = vertex(q, i, j), b = vertex(q, i + 1, j), c = vertex(q, i + 1, j + 1),
                  d = vertex(q, i, j + 1);
        mapped.add({a, b, c}, {at(i, j), at(i + 1, j), at(i + 1, j + 1)});
        mapped.add({a, c, d}, {at(i, j), at(i + 1, j + 1), at(i, j + 1)});
      }
  return mapped;
}

MappedSoup wrapped(int columns, int rows, double du, double dv, bool torus, Eigen::Vector2d offset) {
  MappedSoup mapped;
  for (int j = 0; j < rows + !torus; ++j)
    for (int i = 0; i < columns; ++i) {
      const double a = 2 * M_PI * i / columns, b = 2 * M_PI * j / rows;
      if (torus)
        mapped.soup.points.push_back(
            {(3 + std::cos(b)) * std::cos(a), (3 + std::cos(b)) * std::sin(a), std::sin(b)});
      else
        mapped.soup.points.push_back({std::cos(a), std::sin(a), j * dv});
    }
  const auto vertex = [&](int i, int j) { return (torus ? j % rows : j) * columns + i % columns; };
  const auto at = [&](int i, int j) -> Eigen::Vector2d { return offset + Eigen::Vector2d(i * du, j * dv); };
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      mapped.add({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)},
                 {at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mapped.add({vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)},
                 {at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mapped;
}

std::optional<GridMap> shiftedPlate(int n, const std::vector<ShiftedHole>& holes, double step,
                                    Eigen::Vector2d offset, double turn) {
  const auto soup = sheet(
      n, n, [](int i, int j) { return Eigen::Vector2d(i, j); },
      [&](int i, int j) {
        return std::any_of(holes.begin(), holes.end(), [&](const ShiftedHole& h) {
          return i >= h.column && i < h.column + h.columns && j >= h.row && j < h.row + h.rows;
        });
      });
  const auto turns = [&](const ShiftedHole& hole, int v) {
    const Eigen::Vector2d x = soup.points[v].head<2>() - hole.center();
    return std::atan2(x.y(), x.x()) / (2 * M_PI);
  };
  GridMap map;
  map.mesh = buildSurfaceMesh(soup);
  map.scale.bits = 30;
  map.corner.resize(map.mesh.n_halfedges());
  std::vector<FixedVector> at;
  for (int v = 0; v < int(soup.points.size()); ++v) {
    Eigen::Vector2d x = offset + step * (Eigen::Rotation2Dd(turn) * soup.points[v].head<2>());
    for (const auto& hole : holes) x += turns(hole, v) * Eigen::Vector2d(hole.shift[0], hole.shift[1]);
    at.push_back(map.scale.round(x));
  }
  for (const auto f : map.mesh.faces()) {
    const int first = soup.triangles[f.idx()][0];
    for (const auto h : map.mesh.fh_range(f)) {
      const int v = map.mesh.from_vertex_handle(h).idx();
      FixedVector& x = map.corner[h.idx()] = at[v];
      for (const auto& hole : holes) {  // all corners on one branch of the angle
        const Quanta whole = map.scale.one() * std::llround(turns(hole, first) - turns(hole, v));
        x = x + FixedVector{whole * hole.shift[0], whole * hole.shift[1]};
      }
    }
    const auto h = map.mesh.halfedge_handle(f), next = map.mesh.next_halfedge_handle(h);
    if (orientation(map.from(h), map.from(next), map.to(next)) <= 0) return {};
  }
  return map;
}

void shuffleCharts(GridMap& map, std::mt19937& random) {
  for (const auto f : map.mesh.faces()) {
    const Transition t{
        int(random() % 4),
        {(Quanta(random() % 21) - 10) * map.scale.one(), (Quanta(random() % 21) - 10) * map.scale.one()}};
    for (const auto h : map.mesh.fh_range(f)) map.corner[h.idx()] = t(map.corner[h.idx()]);
  }
}

}  // namespace trimquad::samples
