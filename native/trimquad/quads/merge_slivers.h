#pragma once

#include "trimquad/quads/quad_mesh.h"

namespace trimquad {

/// Merges trimmed cells of less than `fraction` of a whole cell's parametric area with a neighbour, the
/// smallest first, until none is left that can be: across its longest side (in space) whose removal leaves
/// one polygon without a point twice, and which is no feature edge. The merged cell counts as trimmed. Cells
/// that take no part stay as they are, points do in any case, and so does the Euler characteristic. \return
/// how many cells are gone; `quads.mergedSlivers` counts them too
int mergeSlivers(QuadMesh& quads, double fraction);

}  // namespace trimquad
