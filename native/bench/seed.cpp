#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <random>

#include "trimquad/field/curvature_guidance.h"
#include "trimquad/seamless/seamless_map.h"
#include "trimquad/seamless/solve_map.h"
#include "trimquad/seamless/untangle.h"

using namespace trimquad;

namespace {

constexpr double kGuidanceReach = 4;

/// A torus with bumps, closed and with singular vertices: 4 n x 2 n cells of two triangles.
Region bumpyTorus(int n) {
  TriangleSoup soup;
  const int around = 4 * n, across = 2 * n;
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      const double a = 2 * M_PI * i / around, b = 2 * M_PI * j / across,
                   thickness = 1 + 0.35 * std::sin(3 * a) * std::sin(2 * b), r = 3 + thickness * std::cos(b);
      soup.points.push_back({r * std::cos(a), r * std::sin(a), thickness * std::sin(b)});
    }
  const auto at = [&](int i, int j) { return i % around * across + j % across; };
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      soup.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      soup.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  Region region;
  region.name = "torus";
  region.mesh = buildSurfaceMesh(soup);
  return region;
}

CrossField guidedField(const Region& region) {
  return crossField(region, curvatureGuidance(region, Progress()), kGuidanceReach, Progress());
}

/// Field, valid map, and what it was solved with.
struct Prepared {
  Region region;
  CrossField field;
  SeamlessMap map;
  std::unique_ptr<SeamBasis> basis;
  std::unique_ptr<MapEnergy> energy;

  explicit Prepared(int n) : region(bumpyTorus(n)), field(guidedField(region)) {
    StepBudget budget;
    map = seamlessMap(region, field, std::sqrt(surfaceArea(region.mesh) / 1000), Effort::Full, budget,
                      Progress());
    SeamConstraints constraints;
    constraints.aligned = map.alignedSides;
    basis = std::make_unique<SeamBasis>(region.mesh, map.seams, constraints);
    energy = std::make_unique<MapEnergy>(region.mesh, map.target, *basis);
  }
};

void count(benchmark::State& state, const Region& region) {
  state.counters["triangles"] = double(region.mesh.n_faces());
  state.SetComplexityN(std::int64_t(region.mesh.n_faces()));
}

void curvature(benchmark::State& state) {
  const Region region = bumpyTorus(int(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(curvatureGuidance(region, Progress()));
  count(state, region);
}

void closedField(benchmark::State& state) {
  const Region region = bumpyTorus(int(state.range(0)));
  const FieldGuidance guidance = curvatureGuidance(region, Progress());
  int singular = 0;
  for (auto _ : state) {
    const CrossField field = crossField(region, guidance, kGuidanceReach, Progress());
    singular = 0;
    for (const int index : field.index) singular += index != 0;
  }
  state.counters["singular"] = singular;
  count(state, region);
}

void closedSeamless(benchmark::State& state) {
  const Region region = bumpyTorus(int(state.range(0)));
  const CrossField field = guidedField(region);
  const double edgeLength = std::sqrt(surfaceArea(region.mesh) / 1000);
  for (auto _ : state) {
    StepBudget budget;
    benchmark::DoNotOptimize(seamlessMap(region, field, edgeLength, Effort::Full, budget, Progress()));
  }
  count(state, region);
}

void seamBasis(benchmark::State& state) {
  const Region region = bumpyTorus(int(state.range(0)));
  const CrossField field = guidedField(region);
  for (auto _ : state) {
    const SeamGraph seams = seamGraph(region.mesh, field);
    benchmark::DoNotOptimize(SeamBasis(region.mesh, seams, {}));
  }
  count(state, region);
}

void poisson(benchmark::State& state) {
  const Prepared p(int(state.range(0)));
  int flipped = 0;
  for (auto _ : state) {
    const Eigen::VectorXd z = poissonMap(p.region.mesh, p.map.target, *p.basis);
    flipped = p.energy->flipped(p.energy->coordinates(z));
  }
  state.counters["flipped"] = flipped;
  count(state, p.region);
}

/// From a map with about a tenth of the triangles turned over at random places.
void untangling(benchmark::State& state) {
  const Prepared p(int(state.range(0)));
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 0.3 * std::sqrt(1000.0 / double(p.region.mesh.n_faces())));
  Eigen::VectorXd start = poissonMap(p.region.mesh, p.map.target, *p.basis);
  for (double& x : start) x += noise(random);
  const int flipped = p.energy->flipped(p.energy->coordinates(start));
  const auto turnedOver = [&](const Eigen::VectorXd& z) {
    return p.energy->turnedOver(p.energy->coordinates(z));
  };
  MapCounters counters;
  for (auto _ : state) {
    Eigen::VectorXd z = start;
    counters = {};
    StepBudget budget;
    SparseSolver solver("untangle");
    untangle(*p.energy, turnedOver, z, counters, solver, budget, Progress());
    if (p.energy->flipped(p.energy->coordinates(z)) > 0) {
      state.SkipWithError("triangles stay turned over");
      break;
    }
  }
  state.counters["flipped"] = flipped;
  state.counters["neighbourhoods"] = counters.neighbourhoods;
  state.counters["steps"] = counters.untangleIterations;
  count(state, p.region);
}

/// Rounding to fixed-point numbers and verifying every seam and triangle.
void exactness(benchmark::State& state) {
  const Prepared p(int(state.range(0)));
  Eigen::VectorXd x(p.basis->basis().variableCount());
  for (const auto h : p.region.mesh.halfedges()) {
    if (p.region.mesh.is_boundary(h)) continue;
    const Eigen::Vector2d corner = p.map.scale.toQuads(p.map.from(h));
    for (int axis = 0; axis < 2; ++axis) x[p.basis->coordinate(p.basis->wedge(h), axis)] = corner[axis];
    const auto& crossing = p.map.seams.crossing[h.idx()];
    if (!crossing || !crossing->forward) continue;
    const Eigen::Vector2d translation = p.map.scale.toQuads(p.map.transition(h).translation);
    for (int axis = 0; axis < 2; ++axis) x[p.basis->translation(crossing->branch, axis)] = translation[axis];
  }
  const Eigen::VectorXd z = p.basis->basis().restrict(x);
  for (auto _ : state) benchmark::DoNotOptimize(exactMap(p.region.mesh, *p.basis, z, false));
  count(state, p.region);
}

/// 1k to 200k triangles.
void torusSizes(benchmark::internal::Benchmark* bench) {
  for (const int n : {8, 14, 25, 43, 79, 112}) bench->Arg(n);
  bench->ArgName("n")->Unit(benchmark::kMillisecond)->Complexity();
}

}  // namespace

BENCHMARK(curvature)->Apply(torusSizes);
BENCHMARK(closedField)->Apply(torusSizes);
BENCHMARK(seamBasis)->Apply(torusSizes);
BENCHMARK(poisson)->Apply(torusSizes);
BENCHMARK(untangling)->Apply(torusSizes);
BENCHMARK(closedSeamless)->Apply(torusSizes);
BENCHMARK(exactness)->Apply(torusSizes);
