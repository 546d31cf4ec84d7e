#include <benchmark/benchmark.h>

#include <cmath>

#include "trimquad/quads/extract_quads.h"

using namespace trimquad;

namespace {

/// A wavy sheet of n x n cells of two triangles, turned off the grid, a quad for every four triangles.
GridMap wavySheet(int n) {
  TriangleSoup soup;
  std::vector<Eigen::Vector2d> image;
  const double size = n / std::sqrt(2.0);
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double x = double(i) / n, y = double(j) / n;
      soup.points.push_back({size * x, size * y, 2 * std::sin(9 * x) * std::cos(7 * y)});
      image.push_back(size * (Eigen::Rotation2Dd(0.3) * Eigen::Vector2d(x + 0.01 * std::sin(20 * y), y)));
    }
  const auto add = [&](int a, int b, int c) { soup.triangles.push_back({a, b, c}); };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i, b = a + 1, c = b + n + 1, d = a + n + 1;
      add(a, b, c);
      add(a, c, d);
    }
  GridMap map;
  map.mesh = buildSurfaceMesh(soup);
  map.scale = FixedScale::fitting(2 * size);
  map.corner.resize(map.mesh.n_halfedges());
  for (const auto h : map.mesh.halfedges())
    map.corner[h.idx()] = map.scale.round(image[map.mesh.from_vertex_handle(h).idx()]);
  return map;
}

void extractWavySheet(benchmark::State& state) {
  const GridMap map = wavySheet(int(state.range(0)));
  const Progress progress;
  size_t cells = 0;
  for (auto _ : state) cells = extractQuads(map, {}, progress).cells.size();
  state.counters["triangles"] = double(map.mesh.n_faces());
  state.counters["cells"] = double(cells);
  state.SetComplexityN(std::int64_t(map.mesh.n_faces()));
}

}  // namespace

BENCHMARK(extractWavySheet)
    ->RangeMultiplier(2)
    ->Range(35, 560)
    ->Arg(141)
    ->Unit(benchmark::kMillisecond)
    ->Complexity(benchmark::oN);
