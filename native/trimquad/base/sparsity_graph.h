#pragma once

#include <Eigen/Sparse>
#include <span>
#include <vector>

namespace trimquad {

/// The graph of a symmetric sparse matrix: a vertex stands for columns that have the same pattern.
struct SparsityGraph {
  std::vector<int> start{0};   ///< first neighbour by vertex, and the end
  std::vector<int> neighbour;  ///< ascending within a vertex, without the vertex itself
  std::vector<int> weight;     ///< columns that a vertex stands for

  int size() const { return int(weight.size()); }
  std::span<const int> neighbours(int v) const {
    return {neighbour.data() + start[v], neighbour.data() + start[v + 1]};
  }
};

/// A graph whose vertices are classes of columns.
struct ColumnClasses {
  SparsityGraph graph;
  std::vector<int> vertexOf;  ///< by column
};

/// The graph of a symmetric matrix, of which the lower triangle is read. Columns of equal pattern (such as
/// those of the two coordinates of one mesh vertex) become one vertex.
ColumnClasses columnClasses(const Eigen::SparseMatrix<double>& matrix);

}  // namespace trimquad
