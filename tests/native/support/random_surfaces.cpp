#include "support/random_surfaces.h"

#include <vector>

#include "support/random_triangulation.h"
#include "trimquad/base/error.h"

namespace trimquad::samples {

bool connected(const SurfaceMesh& mesh) {
  std::vector<bool> reached(mesh.n_faces(), false);
  std::vector<FaceHandle> waiting{FaceHandle(0)};
  std::size_t count = 0;
  reached[0] = true;
  while (!waiting.empty()) {
    const FaceHandle f = waiting.back();
    waiting.pop_back();
    ++count;
    for (const auto h : mesh.fh_range(f)) {
      const auto o = mesh.opposite_halfedge_handle(h);
      if (mesh.is_boundary(o) || reached[mesh.face_handle(o).idx()]) continue;
      reached[mesh.face_handle(o).idx()] = true;
      waiting.push_back(mesh.face_handle(o));
    }
  }
  return count == mesh.n_faces();
}

MappedSoup pierced(MappedSoup mapped, int count, std::mt19937& random) {
  for (int k = 0; k < count && mapped.soup.triangles.size() > 4; ++k) {
    MappedSoup rest = mapped;
    const std::size_t t = random() % rest.soup.triangles.size();
    rest.soup.triangles.erase(rest.soup.triangles.begin() + long(t));
    rest.corners.erase(rest.corners.begin() + long(t));
    // Vertices that are left alone must go.
    std::vector<int> number(rest.soup.points.size(), -1);
    std::vector<Eigen::Vector3d> points;
    for (auto& triangle : rest.soup.triangles)
      for (int& v : triangle) {
        if (number[v] < 0) number[v] = int(points.size()), points.push_back(rest.soup.points[v]);
        v = number[v];
      }
    rest.soup.points = points;
    try {
      if (connected(buildSurfaceMesh(rest.soup))) mapped = rest;
    } catch (const Error&) {
    }
  }
  return mapped;
}

void jitter(Parametrization& map, Quanta unit, int amplitude, std::mt19937& random) {
  const auto& mesh = map.mesh;
  const auto cones = coneQuarters(map);
  for (const auto v : mesh.vertices()) {
    const auto pick = [&] { return (Quanta(random() % unsigned(2 * amplitude + 1)) - amplitude) * unit; };
    if (!mesh.is_boundary(v) && cones[v.idx()] != 4) continue;
    FixedVector step{pick(), pick()};
    const auto before = map.corner;
    HalfedgeHandle h = mesh.halfedge_handle(v);
    if (mesh.is_boundary(v)) h = mesh.opposite_halfedge_handle(mesh.prev_halfedge_handle(h));
    const HalfedgeHandle first = h;
    bool sound = true;
    std::vector<std::pair<HalfedgeHandle, FixedVector>> moves;
    do {
      moves.emplace_back(h, step);
      const HalfedgeHandle back = mesh.prev_halfedge_handle(h);
      h = mesh.opposite_halfedge_handle(back);
      if (mesh.is_boundary(h)) break;
      step = rotated(step, map.transition(back).rotation);
    } while (h != first);
    for (const auto& [c, move] : moves) map.corner[c.idx()] = map.corner[c.idx()] + move;
    for (const auto& [c, move] : moves)
      sound = sound && orientation(map.from(c), map.to(c), map.from(mesh.prev_halfedge_handle(c))) > 0;
    if (!sound) map.corner = before;
  }
}

void alignSome(Parametrization& map, unsigned oneIn, std::mt19937& random) {
  for (const auto e : map.mesh.edges()) {
    const auto h = map.mesh.halfedge_handle(e, map.mesh.is_boundary(map.mesh.halfedge_handle(e, 0)) ? 1 : 0);
    const FixedVector d = map.to(h) - map.from(h);
    if ((d.u == 0 || d.v == 0) && random() % oneIn == 0) map.aligned.push_back(e);
  }
}

void markSome(Parametrization& map, unsigned oneIn, std::mt19937& random) {
  for (const auto v : map.mesh.vertices())
    if (!map.mesh.is_isolated(v) && random() % oneIn == 0) map.featurePoints.push_back(v);
}

GridMap randomDomain(std::mt19937& random) {
  for (;;) {
    GridMap map = randomTriangulation(random, 90, 8);
    if (connected(map.mesh)) return map;
  }
}

GridMap randomSingularSurface(std::mt19937& random) {
  MappedSoup mapped;
  const int n = 2 + int(random() % 8);
  switch (random() % 3) {
    case 0:
      mapped = cone(2 + int(random() % 6), n, n, int(random() % 3) == 0 ? 1 : 0);
      break;
    case 1:
      mapped = wrapped(3 + n, 2 + n, 1, 1, false);
      break;
    default:
      mapped = wrapped(3 + n, 3 + n, 1, 1, true);
  }
  mapped = pierced(mapped, int(random() % 30), random);
  GridMap map = gridMapOf(mapped, 30);
  if (random() % 4 != 0)
    jitter(map, map.scale.one() >> (random() % 2 == 0 ? 2 : 20), 1 << (random() % 4), random);
  return map;
}

}  // namespace trimquad::samples
