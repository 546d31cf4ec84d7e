#pragma once

#include "trimquad/field/cross_field.h"
#include "trimquad/field/transport.h"

namespace trimquad {

/// Aligned edges that no map can follow together: where the field makes no quarter turn between two that
/// leave a vertex side by side, both run along the same grid line in the same direction, and the triangles
/// between them collapse. Of the two that edge is named which continues another aligned edge less straight;
/// of three around a triangle that lie on one line, the two short ones. Ascending.
std::vector<EdgeHandle> collapsingEdges(const SurfaceMesh& mesh, const Transport& transport,
                                        const CrossField& field);

}  // namespace trimquad
