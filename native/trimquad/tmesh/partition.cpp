#include "trimquad/tmesh/partition.h"

#include "trimquad/tmesh/motorcycles.h"
#include "trimquad/tmesh/patches.h"

namespace trimquad {

TMesh partition(const Parametrization& map, const Progress& progress) {
  verify(map, false);
  progress.report(0.2);
  const MotorcycleGraph graph = driveMotorcycles(map, seeds(map), progress);
  progress.report(0.8);
  TMesh tmesh = completedPatches(map, graph.nodes, straightArcs(map, graph));
  verify(tmesh, eulerCharacteristic(map.mesh));
  return tmesh;
}

}  // namespace trimquad
