#include "trimquad/base/sparse_solver.h"

#include <algorithm>

#include "trimquad/base/error.h"

namespace trimquad {

bool SparseSolver::isAnalysed(const Eigen::SparseMatrix<double>& matrix) const {
  return Eigen::Index(outer_.size()) == matrix.outerSize() + 1 &&
         Eigen::Index(inner_.size()) == matrix.nonZeros() &&
         std::equal(outer_.begin(), outer_.end(), matrix.outerIndexPtr()) &&
         std::equal(inner_.begin(), inner_.end(), matrix.innerIndexPtr());
}

bool SparseSolver::tryFactorize(const Eigen::SparseMatrix<double>& matrix) {
  if (!matrix.isCompressed()) {
    Eigen::SparseMatrix<double> compressed = matrix;
    compressed.makeCompressed();
    return tryFactorize(compressed);
  }
  if (!isAnalysed(matrix)) {
    factor_.analyse(matrix);
    outer_.assign(matrix.outerIndexPtr(), matrix.outerIndexPtr() + matrix.outerSize() + 1);
    inner_.assign(matrix.innerIndexPtr(), matrix.innerIndexPtr() + matrix.nonZeros());
  }
  return factor_.factorize(matrix);
}

void SparseSolver::factorize(const Eigen::SparseMatrix<double>& matrix) {
  if (!tryFactorize(matrix))
    throw stageError(stage_,
                     "a linear system has no unique solution; the surface may have zero-area triangles");
}

}  // namespace trimquad
