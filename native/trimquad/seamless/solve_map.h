#pragma once

#include <optional>
#include <string>

#include "trimquad/base/progress.h"
#include "trimquad/seamless/map_energy.h"
#include "trimquad/seamless/seam_basis.h"
#include "trimquad/seamless/seamless_map.h"

namespace trimquad {

/// The map, z, with the least squared distance to the energy's target.
Eigen::VectorXd leastSquares(const MapEnergy& energy, const SeamBasis& basis);

/// Newton steps on the foldover-free energy until no triangle is flipped, or no progress is made.
void untangle(const MapEnergy& energy, const SeamBasis& basis, Eigen::VectorXd& z, int& iterations,
              const Progress& progress);

/// The Poisson map: the least-squares fit of the target over the basis, z. Triangles may be flipped.
Eigen::VectorXd poissonMap(const SurfaceMesh& mesh, const MapTarget& target, const SeamBasis& basis);

/// The locally injective map nearest to the target over the basis, z. Each of `starts` in turn is a target
/// for a Poisson solve and untangling; where none of them gives an injective map, one is grown from a convex
/// embedding, on a region without singularities; then Newton steps on symmetric Dirichlet energy plus
/// distance to the target. (The ladder of algorithms.md, section 2)
/// \param nearby  a locally injective map, x, for which the equations of the basis hold but for constants;
/// its constants are moved where the first start fails \param index  singularity index per vertex; the map's
/// cone angles are (4 - index) * 90 degrees \param stage  named in the Error(Stage) that is thrown where no
/// rung holds
Eigen::VectorXd solveMap(const SurfaceMesh& mesh, const SeamGraph& seams, const MapTarget& target,
                         const std::vector<MapTarget>& starts, const std::optional<Eigen::VectorXd>& nearby,
                         const std::vector<int>& index, const SeamBasis& basis, const std::string& stage,
                         Effort effort, MapCounters& counters, const Progress& progress);

/// The map of a plane region without seams, z, kept one to one by a scaffold: triangles that fill the holes
/// and surround the outer loop must not collapse either while the map grows from a convex embedding. Other
/// maps are one to one only locally. (After Jiang, Schaefer and Panozzo 2017, without remeshing the scaffold)
/// \param follow weight of the distance to the target beside symmetric Dirichlet energy
Eigen::VectorXd oneToOneMap(const SurfaceMesh& mesh, const SeamGraph& seams, const MapTarget& target,
                            const SeamBasis& basis, double follow, MapCounters& counters,
                            const Progress& progress);

/// The map in fixed-point numbers, at the finest scale that holds it; verified.
Parametrization exactMap(const SurfaceMesh& mesh, const SeamBasis& basis, const Eigen::VectorXd& z,
                         bool integer);

}  // namespace trimquad
