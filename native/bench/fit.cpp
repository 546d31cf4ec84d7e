#include <benchmark/benchmark.h>

#include <cmath>

#include "trimquad/spline/fit_surface.h"
#include "trimquad/spline/spline_space.h"

namespace trimquad {
namespace {

Eigen::Vector3d wave(double u, double v) {
  return {u, v, std::sin(0.4 * u) * std::cos(0.3 * v)};
}

/// One least-squares solve: n x n knot intervals of a quad, `perSide`^2 data in each.
void leastSquares(benchmark::State& state) {
  const int n = int(state.range(0)), perSide = int(state.range(1));
  SplineSpace space{{3, false, {}}, {3, false, {}}};
  for (int i = 0; i <= n; ++i) {
    space.u.breaks.push_back(i);
    space.v.breaks.push_back(i);
  }
  std::vector<Datum> data;
  for (int i = 0; i < n * perSide; ++i)
    for (int j = 0; j < n * perSide; ++j) {
      const double u = (i + 0.5) / perSide, v = (j + 0.5) / perSide;
      data.push_back({{u, v}, wave(u, v), 1.0 / (perSide * perSide)});
    }
  for (auto _ : state) benchmark::DoNotOptimize(space.leastSquares(data, {1e-9, 1e-6}, Progress()));
  state.counters["poles"] = space.poles();
  state.counters["samples"] = double(data.size());
}
BENCHMARK(leastSquares)
    ->Args({15, 4})
    ->Args({42, 4})
    ->Args({42, 8})
    ->Args({60, 4})
    ->Args({100, 4})
    ->Args({150, 3})
    ->Args({313, 3})
    ->Unit(benchmark::kMillisecond)
    ->MinTime(0.2);

/// The whole fit of a sheet of n x n quads, nine triangle pairs each, to a tolerance in thousandths of a
/// quad.
void fitSheet(benchmark::State& state) {
  const int n = int(state.range(0)), cells = 3 * n;
  TriangleSoup soup;
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i) soup.points.push_back(wave(i / 3.0, j / 3.0));
  const auto vertex = [&](int i, int j) { return i + (cells + 1) * j; };
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i) {
      soup.triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
      soup.triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
    }
  Region region;
  region.mesh = buildSurfaceMesh(soup);
  GridMap map;
  map.mesh = region.mesh;
  map.corner.resize(map.mesh.n_halfedges());
  for (const auto f : map.mesh.faces())
    for (const auto h : map.mesh.fh_range(f)) {
      const auto p = map.mesh.point(map.mesh.from_vertex_handle(h));
      map.corner[h.idx()] = map.scale.round(Eigen::Vector2d(p.x(), p.y()));
    }
  size_t poles = 0;
  for (auto _ : state)
    poles = fitSurface(region, map, {.tolerance = 1e-3 * double(state.range(1)), .degree = 3}, Progress())
                .surface.poles.size();
  state.counters["poles"] = double(poles);
  state.counters["triangles"] = double(soup.triangles.size());
}
BENCHMARK(fitSheet)
    ->Args({10, 20})
    ->Args({30, 20})
    ->Args({100, 20})

    ->Unit(benchmark::kMillisecond)
    ->MinTime(0.2);

}  // namespace
}  // namespace trimquad
