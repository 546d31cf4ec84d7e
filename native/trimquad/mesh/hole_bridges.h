#pragma once

#include "trimquad/base/progress.h"
#include "trimquad/mesh/parametrization.h"
#include "trimquad/mesh/region.h"

namespace trimquad {

/// What became of the boundary loops shorter than asked for.
struct HoleCounts {
  int bridged = 0;
  int aligned = 0;    ///< kept, since grid lines are to run along them
  int ends = 0;       ///< kept, since the surface would not go on over them: ends of tubes, outer boundaries
  int inBridges = 0;  ///< triangles that bridge
};

/// Bridges the holes of a region by triangles of about the size of those around (Region::bridge), behind its
/// own ones, which keep their numbers, as its vertices do. A hole is a boundary loop shorter than `length`
/// (model units) without aligned edges that turns around what is missing, and along which the surface faces
/// the side that its bridge does, up to 75 degrees in the mean: ends of tubes and outer boundaries are none.
/// Throws Error(Stage, "bridge") for a hole so narrow that its bridge would have no area.
HoleCounts bridgeHoles(Region& region, double length, const Progress& progress);

/// The region without the triangles that bridge its holes, and without the vertices that only these have; all
/// else keeps its order.
Region withoutBridges(const Region& region);

/// The same of a map of the region's mesh. The meshes of the two results are alike, down to halfedge numbers.
Parametrization withoutBridges(const Parametrization& map, const Region& region);

}  // namespace trimquad
