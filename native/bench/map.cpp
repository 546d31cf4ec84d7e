#include <benchmark/benchmark.h>

#include <cmath>

#include "trimquad/field/curvature_guidance.h"
#include "trimquad/field/singularity_free_field.h"
#include "trimquad/gridmap/grid_map.h"
#include "trimquad/tmesh/partition.h"

using namespace trimquad;

namespace {

/// A wavy sheet of n x n cells of two triangles, or a bent tube of as many.
Region sheetOrTube(int n, bool tube) {
  TriangleSoup soup;
  const int columns = tube ? n : n + 1;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i < columns; ++i) {
      const double s = double(i) / n, t = double(j) / n, a = 2 * M_PI * s, b = M_PI / 2 * t,
                   r = 4 + std::cos(a);
      soup.points.push_back(tube ? Eigen::Vector3d(r * std::cos(b), r * std::sin(b), -std::sin(a))
                                 : Eigen::Vector3d(6 * s, 6 * t, std::sin(6 * s) * std::cos(6 * t)));
    }
  const auto at = [&](int i, int j) { return i % columns + columns * j; };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      soup.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      soup.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  Region region;
  region.name = tube ? "tube" : "sheet";
  region.mesh = buildSurfaceMesh(soup);
  return region;
}

double edgeLengthOf(const Region& region) {
  return std::sqrt(surfaceArea(region.mesh) / 1000);
}

CrossField fieldOf(const Region& region) {
  return singularityFreeField(region.mesh, curvatureGuidance(region, Progress()), 4, Progress());
}

void field(benchmark::State& state) {
  const Region region = sheetOrTube(int(state.range(0)), state.range(1) != 0);
  for (auto _ : state) benchmark::DoNotOptimize(fieldOf(region));
  state.counters["triangles"] = double(region.mesh.n_faces());
  state.SetComplexityN(std::int64_t(region.mesh.n_faces()));
}

void seamless(benchmark::State& state) {
  const Region region = sheetOrTube(int(state.range(0)), state.range(1) != 0);
  const CrossField directions = fieldOf(region);
  for (auto _ : state)
    benchmark::DoNotOptimize(seamlessMap(region, directions, edgeLengthOf(region), Effort::Full, Progress()));
  state.counters["triangles"] = double(region.mesh.n_faces());
  state.SetComplexityN(std::int64_t(region.mesh.n_faces()));
}

void optimize(benchmark::State& state) {
  const Region region = sheetOrTube(int(state.range(0)), state.range(1) != 0);
  const SeamlessMap map =
      seamlessMap(region, fieldOf(region), edgeLengthOf(region), Effort::Full, Progress());
  const TMesh tmesh = partition(map, Progress());
  const Quantization quantization = quantize(tmesh, {}, Progress());
  for (auto _ : state) benchmark::DoNotOptimize(gridMap(map, tmesh, quantization, true, Progress()));
  state.counters["triangles"] = double(region.mesh.n_faces());
  state.SetComplexityN(std::int64_t(region.mesh.n_faces()));
}

void sizes(benchmark::internal::Benchmark* bench) {
  for (const int tube : {0, 1})
    for (const int n : {22, 32, 45, 71, 100, 141, 200, 316}) bench->Args({n, tube});
  bench->ArgNames({"n", "tube"})->Unit(benchmark::kMillisecond);
}

}  // namespace

BENCHMARK(field)->Apply(sizes);
BENCHMARK(seamless)->Apply(sizes);
BENCHMARK(optimize)->Apply(sizes);
