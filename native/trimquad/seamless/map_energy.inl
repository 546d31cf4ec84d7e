#pragma once

#include <cmath>

namespace trimquad {

template <typename Density>
double MapEnergy::value(const Eigen::VectorXd& x, const Density& density, double follow) const {
  double sum = 0;
  for (int f = 0; f < int(local_.size()); ++f) {
    const Jacobian j = jacobian(f, x);
    const double off = 2 * ((j.fzReal - 1) * (j.fzReal - 1) + j.fzImag * j.fzImag +
                            j.fzbarReal * j.fzbarReal + j.fzbarImag * j.fzbarImag);
    sum += local_[f].area * (density(j.norm2(), j.det()).value + local_[f].following * follow * off);
  }
  return sum;
}

template <typename Density>
void MapEnergy::derivatives(const Eigen::VectorXd& x, const Density& density, double follow,
                            Eigen::VectorXd& gradient, Eigen::SparseMatrix<double>& hessian) const {
  Eigen::VectorXd gradientX = Eigen::VectorXd::Zero(offset_.size());
  HessianPattern::Sum sum = pattern_.start();
  for (int f = 0; f < int(local_.size()); ++f) {
    const Jacobian j = jacobian(f, x);
    const MapDensity g = density(j.norm2(), j.det());
    // With p = |fz|, q = |fzbar|: I = 2 (p^2 + q^2), D = p^2 - q^2. The Hessian is diagonal in the directions
    // along the two circles, and a 2 x 2 block radially. (Golla et al. 2018, KP-Newton, for general
    // densities)
    const double p = std::hypot(j.fzReal, j.fzImag), q = std::hypot(j.fzbarReal, j.fzbarImag);
    const double tangentP = 4 * g.dI + 2 * g.dD, tangentQ = 4 * g.dI - 2 * g.dD;
    addTriangle(f, p * tangentP, q * tangentQ, tangentP + p * p * (16 * g.dId + 4 * g.dDd),
                tangentQ + q * q * (-16 * g.dId + 4 * g.dDd), -4 * p * q * g.dDd, tangentP, tangentQ, j,
                follow, gradientX, sum);
  }
  hessian = pattern_.finish(std::move(sum));
  gradient = pattern_.basis().transpose() * gradientX;
}

}  // namespace trimquad
