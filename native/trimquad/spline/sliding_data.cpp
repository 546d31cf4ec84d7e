#include "trimquad/spline/sliding_data.h"

namespace trimquad {
namespace {

/// Part of the squared distance along the free directions that counts: it bounds how far data slide in one
/// round, and makes the problem definite.
constexpr double kSlidingCounts = 0.03;
constexpr int kSlidingSteps = 60;
/// Part of the first residual's norm (that of the inverse of the preconditioner) that is left: the next round
/// linearises anew.
constexpr double kResidualLeft = 1e-3;

}  // namespace

void SlidingData::add(const Datum& datum, const Eigen::Vector3d& point,
                      const std::vector<std::pair<int, double>>& terms) {
  if (datum.free.isZero()) return;
  terms_.insert(terms_.end(), terms.begin(), terms.end());
  rows_.push_back({terms_.size(), point, datum.weight * (1 - kSlidingCounts) * datum.free});
}

Eigen::MatrixXd SlidingData::lost(const Eigen::MatrixXd& x, bool lessPoints) const {
  // The three coordinates of an unknown side by side in memory.
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
  const Rows from = x;
  Rows result = Rows::Zero(x.rows(), 3);
  auto begin = terms_.begin();
  for (const auto& row : rows_) {
    const auto end = terms_.begin() + std::ptrdiff_t(row.end);
    Eigen::RowVector3d at = Eigen::RowVector3d::Zero();
    for (auto term = begin; term != end; ++term) at += term->second * from.row(term->first);
    if (lessPoints) at -= row.point.transpose();
    const Eigen::RowVector3d part = at * row.lost;
    for (auto term = begin; term != end; ++term) result.row(term->first) += term->second * part;
    begin = end;
  }
  return result;
}

Eigen::MatrixXd SlidingData::minimum(Eigen::MatrixXd x,
                                     const std::function<Eigen::MatrixXd(const Eigen::MatrixXd&)>& solve,
                                     const Progress& progress) const {
  if (rows_.empty()) return x;
  const auto product = [](const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    return a.cwiseProduct(b).sum();
  };
  // At x the gradient of the whole distances' problem vanishes.
  Eigen::MatrixXd r = lost(x, true), z = solve(r), p = z;
  Eigen::MatrixXd wholeP = r;  // the whole distances' matrix times p
  double size = product(r, z);
  const double enough = kResidualLeft * kResidualLeft * size;
  for (int step = 0; step < kSlidingSteps && size > enough; ++step) {
    progress.check();
    const Eigen::MatrixXd q = wholeP - lost(p, false);
    const double by = size / product(p, q);
    x += by * p;
    r -= by * q;
    z = solve(r);
    const double now = product(r, z);
    p = z + now / size * p;
    wholeP = r + now / size * wholeP;
    size = now;
  }
  return x;
}

}  // namespace trimquad
