#include "trimquad/base/sparse_solver.h"

#include "trimquad/base/error.h"

namespace trimquad {

bool SparseSolver::tryFactorize(const Eigen::SparseMatrix<double>& matrix) {
  if (analysedSize_ != matrix.rows() || analysedNonZeros_ != matrix.nonZeros()) {
    factor_.analyzePattern(matrix);
    analysedSize_ = matrix.rows();
    analysedNonZeros_ = matrix.nonZeros();
  }
  factor_.factorize(matrix);
  return factor_.info() == Eigen::Success && (matrix.rows() == 0 || factor_.vectorD().minCoeff() > 0);
}

void SparseSolver::factorize(const Eigen::SparseMatrix<double>& matrix) {
  if (!tryFactorize(matrix))
    throw stageError(stage_,
                     "a linear system has no unique solution; the surface may have zero-area triangles");
}

}  // namespace trimquad
