#pragma once

#include "trimquad/quads/quad_mesh.h"

namespace trimquad {

/// Merges trimmed cells of less than `fraction` of a whole cell's parametric area with a neighbour, the
/// smallest first, until none is left that can be: across its longest side (in space) whose removal leaves
/// one polygon without a point twice, and which is no feature edge. The merged cell counts as trimmed. Cells
/// that take no part stay as they are, points do in any case, and so does the Euler characteristic. \return
/// how many cells are gone; `quads.mergedSlivers` counts them too
int mergeSlivers(QuadMesh& quads, double fraction);

/// Takes out trimmed cells that as polygons would be nothing: of less than a millionth of a whole one, where
/// the boundary passes a grid point or line so closely that no reader could tell it from a touch; and those
/// whose corners all lie on one line in space, where the boundary is straight though the map bends it. They
/// go into the neighbour, and grid points beside them onto the boundary, less than 0.002 quads away. The
/// valences of the other inner points and the Euler characteristic stay, and so do whole quads, unless the
/// boundary has a corner on their side. Those for which that cannot be (around irregular vertices, on feature
/// edges, where the surface is less than a cell wide) stay. \return how many are gone; `quads.droppedSlivers`
/// counts them too
int dropVanishingCells(QuadMesh& quads);

}  // namespace trimquad
