#include <benchmark/benchmark.h>

#include <cmath>

#include "trimquad/quantize/quantize.h"
#include "trimquad/tmesh/partition.h"

using namespace trimquad;

namespace {

/// n x n cells of two triangles, turned off the grid, with a square hole in every block of `block` x `block`
/// cells: a peak in each direction of each hole. A quad is as wide as four cells.
Parametrization piercedSheet(int n, int block) {
  TriangleSoup soup;
  std::vector<int> number((n + 1) * (n + 1), -1);
  const auto vertex = [&](int i, int j) {
    int& v = number[j * (n + 1) + i];
    if (v < 0) {
      v = int(soup.points.size());
      const Eigen::Vector2d p = Eigen::Rotation2Dd(0.3) * Eigen::Vector2d(i + 0.2 * std::sin(0.3 * j), j);
      soup.points.push_back({p.x(), p.y(), std::sin(0.1 * i)});
    }
    return v;
  };
  const auto inHole = [&](int k) { return k % block >= block / 3 && k % block < 2 * block / 3; };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      if (inHole(i) && inHole(j)) continue;
      const int a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i + 1, j + 1), d = vertex(i, j + 1);
      soup.triangles.push_back({a, b, c});
      soup.triangles.push_back({a, c, d});
    }
  Parametrization map;
  map.mesh = buildSurfaceMesh(soup);
  map.scale = FixedScale::fitting(n);
  map.corner.resize(map.mesh.n_halfedges());
  for (const auto h : map.mesh.halfedges())
    map.corner[h.idx()] = map.scale.round(map.mesh.point(map.mesh.from_vertex_handle(h)).head<2>() / 4);
  return map;
}

void count(benchmark::State& state, const Parametrization& map, const TMesh& tmesh) {
  state.counters["triangles"] = double(map.mesh.n_faces());
  state.counters["arcs"] = double(tmesh.arcs.size());
}

void partitionPiercedSheet(benchmark::State& state) {
  const Parametrization map = piercedSheet(int(state.range(0)), int(state.range(1)));
  const Progress progress;
  for (auto _ : state) benchmark::DoNotOptimize(partition(map, progress).arcs.size());
  count(state, map, partition(map, progress));
}

void quantizePiercedSheet(benchmark::State& state) {
  const Parametrization map = piercedSheet(int(state.range(0)), int(state.range(1)));
  const Progress progress;
  const TMesh tmesh = partition(map, progress);
  Quantization result;
  for (auto _ : state) result = quantize(tmesh, {}, progress);
  count(state, map, tmesh);
  state.counters["objective"] = result.objective;
  state.counters["zero"] = result.zeroArcs;
}

}  // namespace

BENCHMARK(partitionPiercedSheet)
    ->Args({141, 70})
    ->Args({282, 70})
    ->Args({564, 70})
    ->Args({141, 15})
    ->Args({282, 15})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(quantizePiercedSheet)
    ->Args({70, 35})
    ->Args({70, 15})
    ->Args({140, 15})
    ->Args({280, 15})
    ->Unit(benchmark::kMillisecond);
