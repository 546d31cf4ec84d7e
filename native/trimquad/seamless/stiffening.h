#pragma once

#include "trimquad/base/progress.h"
#include "trimquad/seamless/solve_map.h"

namespace trimquad {

/// Least squares alone may turn triangles over, or let a fan wind around a neighbour of its cone, where the
/// target bends too much to be followed everywhere. Here the target weighs more, from solve to solve, around
/// the vertices at which it goes wrong, until the map is locally injective, untangled or as it is. (Local
/// stiffening: Bommes, Zimmer, Kobbelt 2009) Gives up, with nothing, once fewer and fewer of them is not what
/// comes of it.
/// \param z  where to begin: a map that is not locally injective
std::optional<Eigen::VectorXd> stiffenedMap(const SurfaceMesh& mesh, const MapStart& start,
                                            const std::vector<int>& index, const SeamBasis& basis,
                                            Eigen::VectorXd z, MapCounters& counters, StepBudget& budget,
                                            const Progress& progress);

}  // namespace trimquad
