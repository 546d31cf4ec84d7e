#include "trimquad/embed/embed.h"

#include <benchmark/benchmark.h>

#include <cmath>

#include "trimquad/gridmap/patch_map.h"
#include "trimquad/tmesh/partition.h"

using namespace trimquad;

namespace {

/// A plate of n x n cells of two triangles with 5 x 5 round holes, `quads` wide, turned off the grid: many of
/// the T-mesh's arcs are shorter than a quad.
Parametrization pierced(int n, double quads) {
  TriangleSoup soup;
  std::vector<int> number(std::size_t((n + 1) * (n + 1)), -1);
  const auto inside = [&](double x, double y) {
    const double fx = 5 * x - std::floor(5 * x) - 0.5, fy = 5 * y - std::floor(5 * y) - 0.5;
    return std::hypot(fx, fy) > 0.25;
  };
  const auto at = [&](int i, int j) {
    int& v = number[std::size_t(j * (n + 1) + i)];
    if (v < 0) {
      v = int(soup.points.size());
      soup.points.push_back({double(i) / n, double(j) / n, 0});
    }
    return v;
  };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      if (!inside((i + 0.5) / n, (j + 0.5) / n)) continue;
      soup.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      soup.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  Parametrization map;
  map.mesh = buildSurfaceMesh(soup);
  map.scale = FixedScale::fitting(2 * quads);
  map.corner.resize(map.mesh.n_halfedges());
  const Eigen::Rotation2Dd turned(0.3);
  for (const auto h : map.mesh.halfedges()) {
    const Eigen::Vector3d p = map.mesh.point(map.mesh.from_vertex_handle(h));
    map.corner[h.idx()] = map.scale.round(Eigen::Vector2d(quads * (turned * p.head<2>())));
  }
  return map;
}

/// Arguments: cells along a side, quads along a side.
void embedPiercedPlate(benchmark::State& state) {
  const Parametrization map = pierced(int(state.range(0)), double(state.range(1)));
  const Progress progress;
  const TMesh tmesh = partition(map, progress);
  const Quantization quantization = quantize(tmesh, {}, progress);
  EmbeddedTMesh::Counters counters;
  for (auto _ : state) counters = embed(map, tmesh, quantization, progress).counters;
  state.counters["triangles"] = double(map.mesh.n_faces());
  state.counters["arcs"] = double(tmesh.arcs.size());
  state.counters["collapses"] = counters.zeroArcCollapses;
  state.counters["inserted"] = counters.inserted;
}

void mapPatchesOfPiercedPlate(benchmark::State& state) {
  const Parametrization map = pierced(int(state.range(0)), double(state.range(1)));
  const Progress progress;
  const TMesh tmesh = partition(map, progress);
  const EmbeddedTMesh embedded = embed(map, tmesh, quantize(tmesh, {}, progress), progress);
  int splits = 0;
  for (auto _ : state) splits = constructiveMap(map, embedded, progress).splits;
  state.counters["triangles"] = double(map.mesh.n_faces());
  state.counters["splits"] = splits;
}

}  // namespace

BENCHMARK(embedPiercedPlate)->ArgsProduct({{50, 100, 200}, {10, 30, 100}})->Unit(benchmark::kMillisecond);
BENCHMARK(mapPatchesOfPiercedPlate)->ArgsProduct({{50, 100, 200}, {10, 100}})->Unit(benchmark::kMillisecond);
