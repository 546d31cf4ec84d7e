#include "trimquad/gridmap/grid_map.h"

#include "trimquad/gridmap/node_relations.h"
#include "trimquad/seamless/solve_map.h"

namespace trimquad {

GridMap gridMap(const SeamlessMap& seamless, const TMesh& tmesh, const Quantization& quantization,
                const Progress& progress) {
  GridMap map;
  if (seamless.seams.rotation.empty() && seamless.aligned.empty() && seamless.featurePoints.empty()) {
    // Nothing is bound to integers: the seamless map is a grid map.
    map.counters = seamless.counters;
    static_cast<Parametrization&>(map) = seamless;
    verify(map, true);
    return map;
  }
  SeamConstraints constraints;
  constraints.aligned = seamless.alignedSides;
  constraints.grid = gridPoints(seamless.mesh, seamless.seams, tmesh, quantization);
  const SeamBasis basis(seamless.mesh, seamless.seams, constraints);
  const Eigen::VectorXd z = solveMap(seamless.mesh, seamless.seams, seamless.target, seamless.conformalScale,
                                     seamless.index, basis, "optimize", map.counters, progress);
  static_cast<Parametrization&>(map) = exactMap(seamless.mesh, basis, z, true);
  map.aligned = seamless.aligned;
  map.featurePoints = seamless.featurePoints;
  verify(map, true);
  return map;
}

}  // namespace trimquad
