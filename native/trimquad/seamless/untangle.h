#pragma once

#include <functional>
#include <vector>

#include "trimquad/base/progress.h"
#include "trimquad/base/sparse_solver.h"
#include "trimquad/seamless/map_energy.h"
#include "trimquad/seamless/seamless_map.h"
#include "trimquad/seamless/step_budget.h"

namespace trimquad {

/// The triangles where a map, z, is wrong: those that it turns over, and others that must not stay as they
/// are.
using WrongTriangles = std::function<std::vector<FaceHandle>(const Eigen::VectorXd& z)>;

/// Turns the flipped triangles of a map, z, back: neighbourhood by neighbourhood; where that leaves some
/// wrong, all of them at once, from the same z, and then what is left neighbourhood by neighbourhood.
void untangle(const MapEnergy& energy, const WrongTriangles& wrong, Eigen::VectorXd& z, MapCounters& counters,
              SparseSolver& solver, StepBudget& budget, const Progress& progress);

/// Newton steps on the foldover-free energy until no triangle is flipped, or no progress is made, or the
/// budget is spent.
void untangleWhole(const MapEnergy& energy, Eigen::VectorXd& z, int& iterations, SparseSolver& solver,
                   StepBudget& budget, const Progress& progress);

/// The same in each neighbourhood of wrong triangles, with all around it held, and in ever larger ones where
/// that fails; from where z has it and, where it gets stuck there, from its Poisson map. Neighbourhoods in
/// which no triangle is flipped in the end are kept, others are left as they were. Takes time by the number
/// of wrong triangles rather than by the size of the map.
/// \param kept  grows by the number of neighbourhoods kept
void untangleNeighbourhoods(const MapEnergy& energy, const WrongTriangles& wrong, Eigen::VectorXd& z,
                            int& kept, StepBudget& budget, const Progress& progress);

}  // namespace trimquad
