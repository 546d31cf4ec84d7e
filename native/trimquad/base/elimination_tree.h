#pragma once

#include <vector>

#include "trimquad/base/sparsity_graph.h"

namespace trimquad {

/// The elimination tree of a symmetric matrix: the parent of a vertex is the first later one that its column
/// of the Cholesky factor reaches. Vertices are numbered by their place in `order`, which is a postorder of
/// the tree: every subtree is an interval that ends at its root. (Liu 1990)
struct EliminationTree {
  std::vector<int> order;   ///< vertices of the graph in the order of elimination
  std::vector<int> parent;  ///< by place; the size of the tree at a root
  std::vector<int> count;   ///< by place: rows of the factor's column, its own included, by weight

  int size() const { return int(parent.size()); }
};

/// \param order  any order of elimination; the tree's own is an equivalent one, with the same fill.
EliminationTree eliminationTree(const SparsityGraph& graph, const std::vector<int>& order);

/// Postorder of a forest given by parents (size() at roots), children in ascending order.
std::vector<int> postorder(const std::vector<int>& parent);

}  // namespace trimquad
