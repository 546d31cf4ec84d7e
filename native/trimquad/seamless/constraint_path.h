#pragma once

#include "trimquad/base/progress.h"
#include "trimquad/base/sparse_solver.h"
#include "trimquad/seamless/map_energy.h"
#include "trimquad/seamless/step_budget.h"

namespace trimquad {

/// Takes a locally injective map to the constraints of the basis: the constants of the constraints move from
/// the values they have in x to their own in steps that are as long as a map near the one before can be found
/// for, by a Poisson solve and untangling. Returns z of the basis, or nothing where the steps become too
/// small.
/// \param energy  of the basis
/// \param follow  weight of the distance to its target on the way, beside symmetric Dirichlet energy
/// \param x  coordinates of the basis; all its equations hold but for constants
std::optional<Eigen::VectorXd> followConstraints(const SurfaceMesh& mesh, MapEnergy energy,
                                                 const std::vector<int>& index, const SeamBasis& basis,
                                                 double follow, const Eigen::VectorXd& x,
                                                 MapCounters& counters, SparseSolver& solver,
                                                 StepBudget& budget, const Progress& progress);

}  // namespace trimquad
