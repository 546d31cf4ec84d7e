#pragma once

#include "trimquad/base/progress.h"
#include "trimquad/mesh/parametrization.h"
#include "trimquad/mesh/region.h"

namespace trimquad {

/// What became of the boundary loops shorter than asked for.
struct HoleCounts {
  int bridged = 0;
  int aligned = 0;  ///< kept, since grid lines are to run along them
  int ends = 0;     ///< kept, since the surface does not go around them: ends of tubes, outer boundaries
  int inBridges = 0;  ///< triangles that bridge
};

/// Bridges the holes of a region by triangles of about the size of those around (Region::bridge), behind its
/// own ones, which keep their numbers, as its vertices do. A hole is a boundary loop shorter than `length`
/// (model units) without aligned edges that the surface goes around: in total the loop turns more than half
/// way from a tube's end (0) to a hole in the plane (one full turn to the other side).
/// Throws Error(Stage, "bridge") for a hole so narrow that its bridge would have no area.
HoleCounts bridgeHoles(Region& region, double length, const Progress& progress);

/// The region without the triangles that bridge its holes, and without the vertices that only these have; all
/// else keeps its order.
Region withoutBridges(const Region& region);

/// The same of a map of the region's mesh. The meshes of the two results are alike, down to halfedge numbers.
Parametrization withoutBridges(const Parametrization& map, const Region& region);

}  // namespace trimquad
