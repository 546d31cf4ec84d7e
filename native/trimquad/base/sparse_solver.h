#pragma once

#include <Eigen/Sparse>
#include <string>
#include <vector>

#include "trimquad/base/supernodal_cholesky.h"

namespace trimquad {

/// Solves symmetric positive definite sparse systems. The symbolic analysis is kept as long as the pattern of
/// the matrix stays the same.
class SparseSolver {
 public:
  /// \param stage named in the error when the matrix is not positive definite
  explicit SparseSolver(std::string stage) : stage_(std::move(stage)) {}

  /// Throws Error(Stage) where the matrix is not positive definite. Its lower triangle is read.
  void factorize(const Eigen::SparseMatrix<double>& matrix);
  /// Whether the matrix was positive definite, instead of throwing.
  bool tryFactorize(const Eigen::SparseMatrix<double>& matrix);

  /// One column for each right-hand side.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& rhs) const { return factor_.solve(rhs); }

  /// About how many multiplications a factorisation takes; 0 before the first one.
  double work() const { return factor_.pattern().multiplications; }

 private:
  bool isAnalysed(const Eigen::SparseMatrix<double>& matrix) const;

  std::string stage_;
  SupernodalCholesky factor_;
  std::vector<int> outer_, inner_;  // the pattern analysed
};

}  // namespace trimquad
