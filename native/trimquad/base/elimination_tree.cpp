#include "trimquad/base/elimination_tree.h"

#include <algorithm>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

std::vector<int> inverse(const std::vector<int>& order) {
  std::vector<int> place(order.size());
  for (size_t k = 0; k < order.size(); ++k) place[order[k]] = int(k);
  return place;
}

/// Parents by place in `order`; with path compression. (Liu 1986)
std::vector<int> parents(const SparsityGraph& graph, const std::vector<int>& order) {
  const int n = graph.size();
  const auto place = inverse(order);
  std::vector<int> parent(n, n), ancestor(n, n);
  for (int k = 0; k < n; ++k)
    for (const int u : graph.neighbours(order[k])) {
      int i = place[u];
      while (i < k) {
        const int up = ancestor[i];
        ancestor[i] = k;
        if (up == n) parent[i] = k;
        i = up;
      }
    }
  return parent;
}

/// Sizes of the factor's columns. A row of the factor is a subtree; its size by column follows from the
/// leaves of the subtree and the places where the paths from two leaves meet. (Gilbert, Ng, Peyton 1994)
std::vector<int> columnCounts(const SparsityGraph& graph, const std::vector<int>& order,
                              const std::vector<int>& parent) {
  const int n = graph.size();
  const auto place = inverse(order);
  std::vector<int> first(n);  // the least descendant
  for (int j = 0; j < n; ++j) first[j] = j;
  for (int j = 0; j < n; ++j)
    if (parent[j] < n) first[parent[j]] = std::min(first[parent[j]], first[j]);

  std::vector<int> count(n + 1, 0), lastLeaf(n, n), ancestor(n);
  for (int j = 0; j < n; ++j) ancestor[j] = j;
  const auto root = [&](int i) {
    while (ancestor[i] != i) i = ancestor[i] = ancestor[ancestor[i]];
    return i;
  };
  for (int j = 0; j < n; ++j) {
    const int own = graph.weight[order[j]];
    if (lastLeaf[j] == n) count[j] += own;  // a row without entries left of the diagonal
    count[parent[j]] -= own;
    for (const int u : graph.neighbours(order[j])) {
      const int i = place[u];
      if (i < j || (lastLeaf[i] < n && first[j] <= lastLeaf[i])) continue;
      count[j] += graph.weight[u];
      if (lastLeaf[i] < n) count[root(lastLeaf[i])] -= graph.weight[u];
      lastLeaf[i] = j;
    }
    if (parent[j] < n) ancestor[j] = parent[j];
  }
  for (int j = 0; j < n; ++j) count[parent[j]] += count[j];
  count.pop_back();
  return count;
}

}  // namespace

std::vector<int> postorder(const std::vector<int>& parent) {
  const int n = int(parent.size());
  std::vector<int> firstChild(n + 1, n), sibling(n, n), order, path;
  for (int j = n - 1; j >= 0; --j) {
    sibling[j] = firstChild[parent[j]];
    firstChild[parent[j]] = j;
  }
  order.reserve(n);
  for (int root = firstChild[n]; root < n; root = sibling[root]) {
    path.push_back(root);
    while (!path.empty()) {
      const int j = path.back(), child = firstChild[j];
      if (child < n) {
        firstChild[j] = sibling[child];
        path.push_back(child);
      } else {
        order.push_back(j);
        path.pop_back();
      }
    }
  }
  TRIMQUAD_ASSERT(int(order.size()) == n);
  return order;
}

EliminationTree eliminationTree(const SparsityGraph& graph, const std::vector<int>& order) {
  TRIMQUAD_ASSERT(int(order.size()) == graph.size());
  const int n = graph.size();
  const auto parent = parents(graph, order);
  const auto post = postorder(parent);
  const auto rank = inverse(post);
  EliminationTree tree;
  for (const int k : post) {
    tree.order.push_back(order[k]);
    tree.parent.push_back(parent[k] < n ? rank[parent[k]] : n);
  }
  tree.count = columnCounts(graph, tree.order, tree.parent);
  return tree;
}

}  // namespace trimquad
