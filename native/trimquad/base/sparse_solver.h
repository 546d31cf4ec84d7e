#pragma once

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <string>

namespace trimquad {

/// Solves symmetric positive definite sparse systems. The symbolic analysis is kept as long as the pattern of
/// the matrix stays the same.
class SparseSolver {
 public:
  /// \param stage named in the error when the matrix is not positive definite
  explicit SparseSolver(std::string stage) : stage_(std::move(stage)) {}

  /// Throws Error(Stage) where the matrix is singular.
  void factorize(const Eigen::SparseMatrix<double>& matrix);
  /// Whether the matrix was positive definite, instead of throwing.
  bool tryFactorize(const Eigen::SparseMatrix<double>& matrix);

  Eigen::MatrixXd solve(const Eigen::MatrixXd& rhs) const { return factor_.solve(rhs); }

 private:
  std::string stage_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
  Eigen::Index analysedSize_ = -1, analysedNonZeros_ = -1;
};

}  // namespace trimquad
