#include "trimquad/base/supernodal_cholesky.h"

#include <Eigen/Dense>
#include <algorithm>

#include "trimquad/base/dense_cholesky.h"
#include "trimquad/base/error.h"

namespace trimquad {
namespace {

using Supernode = SupernodalPattern::Supernode;
using ConstBlock = Eigen::Map<const Eigen::MatrixXd>;

/// Adds a child's update matrix to the block and the update matrix of its parent.
void extendAdd(const double* child, int size, const int* place, double* block, const Supernode& node,
               double* update) {
  const int below = node.below();
  for (int j = 0; j < size; ++j, child += size) {
    double* target = place[j] < node.columns
                         ? block + std::int64_t(place[j]) * node.rows
                         : update + std::int64_t(place[j] - node.columns) * below - node.columns;
    for (int i = j; i < size; ++i) target[place[i]] += child[i];
  }
}

}  // namespace

void SupernodalCholesky::analyse(const Eigen::SparseMatrix<double>& matrix) {
  TRIMQUAD_ASSERT(matrix.isCompressed() && matrix.rows() == matrix.cols());
  pattern_ = SupernodalPattern(matrix);
}

bool SupernodalCholesky::factorize(const Eigen::SparseMatrix<double>& matrix) {
  const auto& nodes = pattern_.supernodes;
  values_.resize(pattern_.numbers);
  stack_.resize(pattern_.stack);
  std::vector<double> scratch;
  std::vector<int> waiting;  // supernodes whose update matrices are on the stack
  double* top = stack_.data();
  for (int s = 0; s < int(nodes.size()); ++s) {
    const Supernode& node = nodes[s];
    const auto lastEntry = s + 1 < int(nodes.size()) ? nodes[s + 1].firstEntry : int(pattern_.entry.size());
    std::fill_n(values_.data() + node.values, std::int64_t(node.columns) * node.rows, 0.0);
    for (int e = node.firstEntry; e < lastEntry; ++e)
      values_[pattern_.entry[e].place] += matrix.valuePtr()[pattern_.entry[e].source];
    double *block = values_.data() + node.values, *update = top;
    const std::int64_t size = std::int64_t(node.below()) * node.below();
    std::fill_n(update, size, 0.0);
    double* base = top;
    while (!waiting.empty() && nodes[waiting.back()].parent == s) {
      const Supernode& child = nodes[waiting.back()];
      base -= std::int64_t(child.below()) * child.below();
      extendAdd(base, child.below(), pattern_.rowInParent.data() + child.firstRow, block, node, update);
      waiting.pop_back();
    }
    if (!eliminate(block, node.rows, node.columns, update, scratch)) return false;
    if (base != update) std::copy_n(update, size, base);
    top = base + size;
    waiting.push_back(s);
  }
  return true;
}

Eigen::MatrixXd SupernodalCholesky::solve(const Eigen::MatrixXd& rhs) const {
  TRIMQUAD_ASSERT(rhs.rows() == pattern_.size);
  const int sides = int(rhs.cols());
  Eigen::MatrixXd x(rhs.rows(), sides), part;
  for (int j = 0; j < pattern_.size; ++j) x.row(j) = rhs.row(pattern_.order[j]);
  for (const Supernode& node : pattern_.supernodes) {
    const ConstBlock block(values_.data() + node.values, node.rows, node.columns);
    auto mine = x.middleRows(node.firstColumn, node.columns);
    block.topRows(node.columns).triangularView<Eigen::Lower>().solveInPlace(mine);
    part.noalias() = block.bottomRows(node.below()) * mine;
    for (int i = 0; i < node.below(); ++i) x.row(pattern_.row[node.firstRow + i]) -= part.row(i);
  }
  for (int s = int(pattern_.supernodes.size()) - 1; s >= 0; --s) {
    const Supernode& node = pattern_.supernodes[s];
    const ConstBlock block(values_.data() + node.values, node.rows, node.columns);
    auto mine = x.middleRows(node.firstColumn, node.columns);
    part.resize(node.below(), sides);
    for (int i = 0; i < node.below(); ++i) part.row(i) = x.row(pattern_.row[node.firstRow + i]);
    mine.noalias() -= block.bottomRows(node.below()).transpose() * part;
    block.topRows(node.columns).transpose().triangularView<Eigen::Upper>().solveInPlace(mine);
  }
  Eigen::MatrixXd result(rhs.rows(), sides);
  for (int j = 0; j < pattern_.size; ++j) result.row(pattern_.order[j]) = x.row(j);
  return result;
}

}  // namespace trimquad
