#pragma once

#include <Eigen/Core>
#include <vector>

#include "trimquad/base/progress.h"

namespace trimquad {

/// A symmetric positive definite matrix whose entries stand in blocks beside the diagonal blocks at most, and
/// its Cholesky factor in place. Dense blocks: for the normal equations of tensor-product splines, where the
/// band is full, this is several times faster than a general sparse factorisation. Memory: 16 * size *
/// blockSize bytes.
class BlockCholesky {
 public:
  BlockCholesky(int size, int blockSize);

  /// Adds to entry (i, j), i >= j, whose blocks are the same or neighbours.
  void add(int i, int j, double value) {
    const int block = j / blockSize_;
    const int row = i - block * blockSize_, column = j - block * blockSize_;
    if (row < blockSize_)
      diagonal_[block](row, column) += value;
    else
      below_[block](row - blockSize_, column) += value;
  }

  /// False where the matrix is not positive definite.
  bool factorize(const Progress& progress);
  void solveInPlace(Eigen::MatrixXd& rhs) const;

 private:
  int blockSize_;
  std::vector<Eigen::MatrixXd> diagonal_, below_;
};

}  // namespace trimquad
