#include "trimquad/gridmap/grid_map.h"

#include <algorithm>
#include <cmath>

#include "trimquad/base/error.h"
#include "trimquad/seamless/solve_map.h"

namespace trimquad {

GridMap gridMap(const SeamlessMap& seamless, const Progress& progress) {
  GridMap map;
  map.counters = seamless.counters;
  if (seamless.seams.rotation.empty()) {
    // Without seams nothing is bound to integers: the seamless map is a grid map.
    static_cast<Parametrization&>(map) = seamless;
    verify(map, true);
    return map;
  }
  if (!seamless.seams.tube)
    throw stageError("optimize",
                     "the region needs irregular vertices, whose places this version does not round yet");
  std::vector<BranchTranslation> translations(seamless.seams.rotation.size());
  std::vector<char> known(translations.size(), 0);
  for (const auto h : seamless.mesh.halfedges()) {
    const auto& crossing = seamless.seams.crossing[h.idx()];
    if (!crossing || !crossing->forward || known[crossing->branch]) continue;
    known[crossing->branch] = 1;
    const Eigen::Vector2d t = seamless.scale.toQuads(seamless.transition(h).translation);
    for (int axis = 0; axis < 2; ++axis) {
      int whole = int(std::lround(t[axis]));
      if (whole == 0 && t[axis] != 0) whole = t[axis] > 0 ? 1 : -1;
      translations[crossing->branch][axis] = whole;
    }
  }
  const SeamBasis basis(seamless.mesh, seamless.seams, translations, seamless.alignedSides);
  map.counters = {};
  const Eigen::VectorXd z = solveMap(seamless.mesh, seamless.seams, seamless.target, seamless.conformalScale,
                                     seamless.index, basis, "optimize", map.counters, progress);
  static_cast<Parametrization&>(map) = exactMap(seamless.mesh, basis, z, true);
  return map;
}

}  // namespace trimquad
