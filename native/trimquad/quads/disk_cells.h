#pragma once

#include <vector>

#include "trimquad/quads/planar_loop.h"
#include "trimquad/quads/quad_mesh.h"

namespace trimquad {

/// A cell with holes, or one that touches itself, drawn in the plane.
struct PlanarCell {
  CellId cell;
  std::vector<PlanarLoop> loops;  ///< of quad points, the outer loop first
};

/// Makes polygons without holes of such cells: of every cell that still has several loops, or a loop that
/// touches itself, the simple polygons are listed.
///
/// A diagonal from a hole to an inner point would give that point more edges than it has quads. So where the
/// diagonals cannot all end on the surface's boundary, a side of the cell is led through the hole first: the
/// two cells that met in a -> b meet in a -> hole and hole -> b instead, and each has one bank of the hole. A
/// side that is an aligned edge stays; a cell that has no other is cut by diagonals to inner points. A cell
/// that reaches around a hole to both sides of a side, or of an inner point, becomes two there.
void makeDisks(QuadMesh& quads, std::vector<PlanarCell> cells);

}  // namespace trimquad
