#pragma once

#include <algorithm>

#include "trimquad/base/sparse_solver.h"
#include "trimquad/seamless/map_energy.h"

namespace trimquad {

/// The density of the distance to the target alone, which is quadratic: one Newton step leads to its least.
inline MapDensity noDistortion(double, double) {
  return {0, 0, 0, 0, 0};
}

/// One projected Newton step, with the unknowns `held` where they are, on `density` + follow * |J - 1|^2,
/// with backtracking. Returns the relative decrease of the energy. \param keepInjective  stay within nine
/// tenths of the step at which a first triangle collapses
template <typename Density>
double newtonStep(const MapEnergy& energy, const Density& density, double follow, bool keepInjective,
                  SparseSolver& solver, Eigen::VectorXd& z, const std::vector<int>& held = {}) {
  if (z.size() == 0) return 0;
  const Eigen::VectorXd x = energy.coordinates(z);
  Eigen::VectorXd gradient;
  Eigen::SparseMatrix<double> hessian;
  energy.derivatives(x, density, follow, gradient, hessian);
  const double stiffest = hessian.diagonal().maxCoeff();
  for (const int i : held) {
    gradient[i] = 0;
    hessian.coeffRef(i, i) += 1e6 * stiffest;
  }
  double ridge = 1e-10 * hessian.diagonal().mean();
  for (;;) {
    for (int i = 0; i < hessian.rows(); ++i) hessian.coeffRef(i, i) += ridge;
    if (solver.tryFactorize(hessian)) break;
    ridge *= 100;
    if (!(ridge < 1e10 * hessian.diagonal().mean())) return 0;
  }
  const Eigen::VectorXd direction = -solver.solve(gradient);
  const double slope = gradient.dot(direction), before = energy.value(x, density, follow);
  if (!(slope < 0)) return 0;
  const Eigen::VectorXd directionX = energy.movement(direction);
  double step = 1;
  if (keepInjective) step = std::min(step, 0.9 * energy.stepToCollapse(x, directionX));
  for (int halving = 0; halving < 40; ++halving, step /= 2) {
    const double after = energy.value(x + step * directionX, density, follow);
    if (after <= before + 1e-4 * step * slope) {
      z += step * direction;
      return (before - after) / before;
    }
  }
  return 0;
}

}  // namespace trimquad
