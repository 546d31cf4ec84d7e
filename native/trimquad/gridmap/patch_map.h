#pragma once

#include "trimquad/base/progress.h"
#include "trimquad/embed/embedded_tmesh.h"

namespace trimquad {

/// A grid map put together from one map per patch, and the mesh that it needs.
struct PatchMap {
  EmbeddedTMesh embedded;  ///< its mesh is the map's
  Parametrization map;     ///< every patch in a chart of its own
  int splits = 0;          ///< edges inside patches that joined two points of one side
  int meanValue = 0, uniform = 0, progressive = 0;  ///< patches by how they were mapped
};

/// Maps every patch one to one onto its rectangle, the arcs between them alike from both sides (paper,
/// section 6.2): a grid map with the quantized lengths, exact and valid whatever the shapes, but distorted.
/// Virtual arcs are straight here; free boundaries take their shape in the optimisation. \param seamless  the
/// map that the T-mesh is of: it gives the weights Throws Error(Stage, "optimize") naming a patch whose map
/// does not fit the numbers.
PatchMap constructiveMap(const Parametrization& seamless, EmbeddedTMesh embedded, const Progress& progress);

}  // namespace trimquad
