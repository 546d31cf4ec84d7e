#include "trimquad/base/fill_reducing_order.h"

#include <Eigen/OrderingMethods>

namespace trimquad {

std::vector<int> fillReducingOrder(const SparsityGraph& graph) {
  using Pattern = Eigen::SparseMatrix<double>;
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(graph.neighbour.size() / 2 + size_t(graph.size()));
  for (int v = 0; v < graph.size(); ++v) {
    entries.emplace_back(v, v, 1.0);  // Eigen takes vertices without a diagonal entry for dense ones
    for (const int u : graph.neighbours(v))
      if (u > v) entries.emplace_back(u, v, 1.0);
  }
  Pattern pattern(graph.size(), graph.size());
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(pattern.selfadjointView<Eigen::Lower>(), order);
  return {order.indices().data(), order.indices().data() + order.size()};
}

}  // namespace trimquad
