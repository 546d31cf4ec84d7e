#include "trimquad/base/elimination_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <set>

#include "trimquad/base/fill_reducing_order.h"

namespace trimquad {
namespace {

/// A random symmetric pattern; every second one with columns in pairs of equal pattern.
Eigen::SparseMatrix<double> randomPattern(unsigned seed) {
  std::mt19937 random(seed);
  const int copies = seed % 2 == 0 ? 1 : 2, n = 1 + int(random() % 60), edges = int(random() % (2 * n));
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](int i, int j) {
    for (int a = 0; a < copies; ++a)
      for (int b = 0; b < copies; ++b) entries.emplace_back(i + n * a, j + n * b, 1.0);
  };
  for (int i = 0; i < n; ++i) add(i, i);
  for (int e = 0; e < edges; ++e) {
    const int i = int(random() % n), j = int(random() % n);
    add(i, j);
    add(j, i);
  }
  Eigen::SparseMatrix<double> matrix(copies * n, copies * n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

TEST(SparsityGraph, classesAreTheColumnsOfEqualPattern) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    const auto matrix = randomPattern(seed);
    const auto classes = columnClasses(matrix);
    const Eigen::MatrixXd dense(matrix);
    const int n = int(matrix.cols());
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const bool equal = ((dense.col(i).array() != 0) == (dense.col(j).array() != 0)).all();
        EXPECT_EQ(classes.vertexOf[i] == classes.vertexOf[j], equal);
        const auto neighbours = classes.graph.neighbours(classes.vertexOf[i]);
        EXPECT_TRUE(std::is_sorted(neighbours.begin(), neighbours.end()));
        EXPECT_EQ(std::binary_search(neighbours.begin(), neighbours.end(), classes.vertexOf[j]),
                  dense(i, j) != 0 && !equal);
      }
    EXPECT_EQ(std::accumulate(classes.graph.weight.begin(), classes.graph.weight.end(), 0), n);
  }
}

TEST(EliminationTree, agreesWithEliminatingVertexByVertex) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    const auto graph = columnClasses(randomPattern(seed)).graph;
    std::vector<int> order(graph.size());
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), std::mt19937(seed));
    const auto tree = eliminationTree(graph, order);

    std::vector<int> place(graph.size());
    for (int k = 0; k < tree.size(); ++k) place[tree.order[k]] = k;
    std::vector<std::set<int>> later(graph.size());
    for (int v = 0; v < graph.size(); ++v)
      for (const int u : graph.neighbours(v))
        if (place[u] > place[v]) later[place[v]].insert(place[u]);
    for (int k = 0; k < tree.size(); ++k) {
      int count = graph.weight[tree.order[k]];
      for (const int i : later[k]) count += graph.weight[tree.order[i]];
      EXPECT_EQ(tree.count[k], count);
      ASSERT_EQ(tree.parent[k], later[k].empty() ? tree.size() : *later[k].begin());
      if (!later[k].empty()) later[tree.parent[k]].insert(std::next(later[k].begin()), later[k].end());
    }
    // A postorder: the descendants of a vertex are the vertices right before it.
    std::vector<int> descendants(tree.size() + 1, 0);
    for (int k = 0; k < tree.size(); ++k) {
      for (int i = k - descendants[k]; i < k; ++i) {
        int up = i;
        while (up < k) up = tree.parent[up];
        EXPECT_EQ(up, k);
      }
      descendants[tree.parent[k]] += descendants[k] + 1;
    }
  }
}

TEST(FillReducingOrder, isAPermutation) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    const auto graph = columnClasses(randomPattern(seed)).graph;
    auto order = fillReducingOrder(graph);
    std::sort(order.begin(), order.end());
    ASSERT_EQ(int(order.size()), graph.size());
    for (int k = 0; k < graph.size(); ++k) EXPECT_EQ(order[k], k);
  }
}

}  // namespace
}  // namespace trimquad
