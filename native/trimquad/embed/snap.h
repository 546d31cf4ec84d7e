#pragma once

#include <vector>

#include "trimquad/embed/insert_arcs.h"

namespace trimquad {

/// Takes vertices out of the mesh that the input has not, by collapsing each onto a neighbour, wherever this
/// changes neither the surface nor how the paths lie to each other (paper, section 6.1: "snap"): the
/// neighbour lies in the closure of what the vertex lies in; either no path goes through it, or the path goes
/// from one to the other; no triangle becomes flat. `nodes` and `paths` are kept up to date. The
/// mesh's elements are marked as deleted: see `compact`.
/// \param nodes  distinct vertices, among them the ends of all paths
/// \return how many vertices were taken out
int snap(const SurfaceMesh& input, RefinedMesh& refined, const std::vector<VertexHandle*>& nodes,
         const std::vector<EdgePath*>& paths);

}  // namespace trimquad
