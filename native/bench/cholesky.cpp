#include <benchmark/benchmark.h>

#include "trimquad/base/sparse_solver.h"

using namespace trimquad;

namespace {

/// A triangulated sheet of n x n vertices with `copies` coupled unknowns each.
Eigen::SparseMatrix<double> sheetMatrix(int n, int copies) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto join = [&](int i, int j) {
    for (int a = 0; a < copies; ++a)
      for (int b = 0; b < copies; ++b) {
        const double s = a == b ? 1 : 0.2;
        for (const auto& [p, q, sign] : {std::tuple(i, i, 1.0), {j, j, 1.0}, {i, j, -1.0}, {j, i, -1.0}})
          entries.emplace_back(copies * p + a, copies * q + b, sign * s);
      }
  };
  for (int i = 0; i < copies * n * n; ++i) entries.emplace_back(i, i, 1e-3);
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const int v = n * y + x;
      if (x + 1 < n) join(v, v + 1);
      if (y + 1 < n) join(v, v + n);
      if (x + 1 < n && y + 1 < n) join(v, v + n + 1);
    }
  Eigen::SparseMatrix<double> matrix(copies * n * n, copies * n * n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

void choleskyAnalysis(benchmark::State& state) {
  const auto matrix = sheetMatrix(int(state.range(0)), int(state.range(1)));
  std::int64_t numbers = 0, stack = 0;
  for (auto _ : state) {
    const SupernodalPattern pattern(matrix);
    numbers = pattern.numbers;
    stack = pattern.stack;
  }
  state.counters["unknowns"] = double(matrix.rows());
  state.counters["factor"] = double(numbers);
  state.counters["stack"] = double(stack);
}

void choleskyFactorisation(benchmark::State& state) {
  const auto matrix = sheetMatrix(int(state.range(0)), int(state.range(1)));
  SupernodalCholesky cholesky;
  cholesky.analyse(matrix);
  double operations = 0;
  for (const auto& node : cholesky.pattern().supernodes)
    for (int j = 0; j < node.columns; ++j) operations += double(node.rows - j) * double(node.rows - j);
  for (auto _ : state) benchmark::DoNotOptimize(cholesky.factorize(matrix));
  state.counters["unknowns"] = double(matrix.rows());
  state.counters["supernodes"] = double(cholesky.pattern().supernodes.size());
  state.counters["flops"] = benchmark::Counter(operations, benchmark::Counter::kIsIterationInvariantRate);
}

void choleskySolve(benchmark::State& state) {
  const auto matrix = sheetMatrix(int(state.range(0)), int(state.range(1)));
  SupernodalCholesky cholesky;
  cholesky.analyse(matrix);
  cholesky.factorize(matrix);
  const Eigen::MatrixXd rhs = Eigen::MatrixXd::Ones(matrix.rows(), 1);
  for (auto _ : state) benchmark::DoNotOptimize(cholesky.solve(rhs));
  state.counters["unknowns"] = double(matrix.rows());
}

void sheetSizes(benchmark::internal::Benchmark* bench) {
  for (const int copies : {1, 2})
    for (const int n : {71, 100, 141, 224, 316}) bench->Args({n, copies});
  bench->ArgNames({"n", "copies"})->Unit(benchmark::kMillisecond);
}

}  // namespace

BENCHMARK(choleskyAnalysis)->Apply(sheetSizes);
BENCHMARK(choleskyFactorisation)->Apply(sheetSizes);
BENCHMARK(choleskySolve)->Apply(sheetSizes);
