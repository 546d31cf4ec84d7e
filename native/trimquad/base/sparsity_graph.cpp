#include "trimquad/base/sparsity_graph.h"

#include <algorithm>
#include <cstdint>

namespace trimquad {
namespace {

/// Scrambles a column's number, so that sums of them tell patterns apart. (splitmix64)
std::uint64_t scrambled(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

struct Adjacency {  // with the column itself, ascending
  std::vector<int> start, entry;
  std::span<const int> of(int column) const {
    return {entry.data() + start[column], entry.data() + start[column + 1]};
  }
};

Adjacency adjacency(const Eigen::SparseMatrix<double>& matrix) {
  const int n = int(matrix.cols());
  using Iterator = Eigen::SparseMatrix<double>::InnerIterator;
  Adjacency result;
  result.start.assign(n + 1, 0);
  for (int j = 0; j < n; ++j) {
    ++result.start[j + 1];  // the diagonal, stored or not
    for (Iterator it(matrix, j); it; ++it)
      if (it.row() > j) ++result.start[j + 1], ++result.start[it.row() + 1];
  }
  for (int j = 0; j < n; ++j) result.start[j + 1] += result.start[j];
  result.entry.resize(result.start[n]);
  std::vector<int> next(result.start.begin(), result.start.end() - 1);
  // Column by column, each list receives smaller columns first, then itself, then larger ones.
  for (int j = 0; j < n; ++j) {
    result.entry[next[j]++] = j;
    for (Iterator it(matrix, j); it; ++it)
      if (it.row() > j) {
        result.entry[next[j]++] = int(it.row());
        result.entry[next[it.row()]++] = j;
      }
  }
  return result;
}

}  // namespace

ColumnClasses columnClasses(const Eigen::SparseMatrix<double>& matrix) {
  const int n = int(matrix.cols());
  const Adjacency columns = adjacency(matrix);
  std::vector<std::uint64_t> hash(n, 0);
  for (int j = 0; j < n; ++j)
    for (const int i : columns.of(j)) hash[j] += scrambled(std::uint64_t(i));

  ColumnClasses result;
  result.vertexOf.assign(n, n);
  std::vector<int> representative;
  for (int j = 0; j < n; ++j) {
    if (result.vertexOf[j] < n) continue;
    const int v = result.graph.size();
    result.vertexOf[j] = v;
    result.graph.weight.push_back(1);
    representative.push_back(j);
    const auto mine = columns.of(j);
    // Equal patterns with diagonals contain each other's column, so that neighbours are all there is to try.
    for (const int i : mine) {
      if (i <= j || hash[i] != hash[j] || result.vertexOf[i] < n) continue;
      const auto other = columns.of(i);
      if (!std::equal(mine.begin(), mine.end(), other.begin(), other.end())) continue;
      result.vertexOf[i] = v;
      ++result.graph.weight[v];
    }
  }
  result.graph.start.reserve(representative.size() + 1);
  std::vector<int> seenFrom(representative.size(), n);
  for (int v = 0; v < int(representative.size()); ++v) {
    seenFrom[v] = v;
    for (const int i : columns.of(representative[v])) {
      const int u = result.vertexOf[i];
      if (seenFrom[u] == v) continue;
      seenFrom[u] = v;
      result.graph.neighbour.push_back(u);
    }
    std::sort(result.graph.neighbour.begin() + result.graph.start.back(), result.graph.neighbour.end());
    result.graph.start.push_back(int(result.graph.neighbour.size()));
  }
  return result;
}

}  // namespace trimquad
