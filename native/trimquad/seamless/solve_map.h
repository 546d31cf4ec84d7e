#pragma once

#include <optional>
#include <string>

#include "trimquad/base/progress.h"
#include "trimquad/base/sparse_solver.h"
#include "trimquad/seamless/map_energy.h"
#include "trimquad/seamless/seam_basis.h"
#include "trimquad/seamless/seamless_map.h"
#include "trimquad/seamless/step_budget.h"

namespace trimquad {

/// The map, z, with the least squared distance to the energy's target.
Eigen::VectorXd leastSquares(const MapEnergy& energy, SparseSolver& solver);

/// The Poisson map: the least-squares fit of the target over the basis, z. Triangles may be flipped.
Eigen::VectorXd poissonMap(const SurfaceMesh& mesh, const MapTarget& target, const SeamBasis& basis);

/// A Poisson solve that the search for a map starts from, and untangling with the same weights.
struct MapStart {
  const MapTarget* target;
  double evenness;  ///< triangles weigh area^(1 - evenness); at 1 small ones count as much as large ones
};

/// The starts from these targets, in the order in which they are tried. Of weights by area small features
/// with singularities close together come out folded: large triangles far away outvote them.
std::vector<MapStart> startsOf(const std::vector<const MapTarget*>& targets);

/// What a map is solved for.
struct MapProblem {
  const SurfaceMesh& mesh;
  const SeamGraph& seams;
  const MapTarget& target;
  std::vector<MapStart> starts;
  const std::vector<int>& index;  ///< by vertex, singularity index; cone angles are (4 - index) * 90 degrees
  double follow;                  ///< weight of the distance to the target beside symmetric Dirichlet energy
  const SeamBasis& basis;
  std::string stage;  ///< named in errors
};

/// Whether a map, z, has no flipped triangle, not even when it is rounded, and winds around every vertex as
/// its index says.
bool isInjective(const MapProblem& problem, const MapEnergy& energy, const Eigen::VectorXd& z);

/// Maps, z, that untangling came to from the starts, one after the other up to the first that is locally
/// injective.
struct UntangledMaps {
  std::vector<Eigen::VectorXd> reached;
  std::optional<Eigen::VectorXd> injective;
};

/// The first rungs of the ladder: the Poisson map of the first start; then Poisson maps and untangling from
/// each of the starts. (algorithms.md, section 2)
/// \param nearby  a locally injective map, x, for which the equations of the basis hold but for constants;
/// its constants are moved where the first start fails
UntangledMaps untangledMaps(const MapProblem& problem, const std::optional<Eigen::VectorXd>& nearby,
                            Effort effort, MapCounters& counters, StepBudget& budget,
                            const Progress& progress);

/// The last rungs: a map grown from a convex embedding, on a region without singularities, and stiffening.
/// Throws Error(Stage) where they fail as well.
Eigen::VectorXd stubbornMap(const MapProblem& problem, const UntangledMaps& maps, Effort effort,
                            MapCounters& counters, StepBudget& budget, const Progress& progress);

/// Takes a locally injective map, z, to the one nearest to the target: Newton steps on symmetric Dirichlet
/// energy plus distance to the target.
void optimize(const MapProblem& problem, Eigen::VectorXd& z, MapCounters& counters, const Progress& progress);

/// The locally injective map nearest to the target over the basis, z, by all rungs.
Eigen::VectorXd solveMap(const MapProblem& problem, const std::optional<Eigen::VectorXd>& nearby,
                         StepBudget budget, MapCounters& counters, const Progress& progress);

/// The map of a plane region without seams, z, kept one to one by a scaffold: triangles that fill the holes
/// and surround the outer loop must not collapse either while the map grows from a convex embedding. Other
/// maps are one to one only locally. The outer loop stays about a quad away from itself.
/// (After Jiang, Schaefer and Panozzo 2017)
/// \param follow weight of the distance to the target beside symmetric Dirichlet energy
Eigen::VectorXd oneToOneMap(const SurfaceMesh& mesh, const SeamGraph& seams, const MapTarget& target,
                            const SeamBasis& basis, double follow, MapCounters& counters,
                            const Progress& progress);

/// The map in fixed-point numbers, at the finest scale that holds it; verified.
Parametrization exactMap(const SurfaceMesh& mesh, const SeamBasis& basis, const Eigen::VectorXd& z,
                         bool integer);

}  // namespace trimquad
