#include "trimquad/spline/block_cholesky.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace trimquad {

BlockCholesky::BlockCholesky(int size, int blockSize) : blockSize_(blockSize) {
  for (int start = 0; start < size; start += blockSize) {
    const int rows = std::min(blockSize, size - start);
    diagonal_.push_back(Eigen::MatrixXd::Zero(rows, rows));
    if (start > 0) below_.push_back(Eigen::MatrixXd::Zero(rows, blockSize));
  }
}

bool BlockCholesky::factorize(const Progress& progress) {
  for (size_t k = 0; k < diagonal_.size(); ++k) {
    progress.check();
    Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(diagonal_[k]);
    if (factor.info() != Eigen::Success) return false;
    if (k + 1 == diagonal_.size()) break;
    diagonal_[k].triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(below_[k]);
    diagonal_[k + 1].selfadjointView<Eigen::Lower>().rankUpdate(below_[k], -1);
  }
  return true;
}

void BlockCholesky::solveInPlace(Eigen::MatrixXd& rhs) const {
  const auto rows = [&](size_t k) {
    return rhs.middleRows(Eigen::Index(k) * blockSize_, diagonal_[k].rows());
  };
  for (size_t k = 0; k < diagonal_.size(); ++k) {
    auto here = rows(k);
    if (k > 0) here -= below_[k - 1] * rows(k - 1);
    diagonal_[k].triangularView<Eigen::Lower>().solveInPlace(here);
  }
  for (size_t k = diagonal_.size(); k-- > 0;) {
    auto here = rows(k);
    if (k + 1 < diagonal_.size()) here -= below_[k].transpose() * rows(k + 1);
    diagonal_[k].triangularView<Eigen::Lower>().transpose().solveInPlace(here);
  }
}

}  // namespace trimquad
