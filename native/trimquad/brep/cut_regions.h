#pragma once

#include <vector>

#include "trimquad/mesh/region.h"

// This order: OpenCASCADE's macros must not reach the mesh headers.
#include "trimquad/brep/cad_model.h"
#include "trimquad/brep/feature_edges.h"
#include "trimquad/brep/welded_mesh.h"

namespace trimquad {

/// The welded mesh cut open along the edges in `cut` (per CAD edge), with its curves, corners and shells. The
/// meshes are BRepMesh's triangles; boundary vertices lie on their curves.
Model cutRegions(const CadModel& cad, const WeldedMesh& mesh, const SideUses& uses,
                 const std::vector<char>& cut, const std::vector<char>& reversed);

}  // namespace trimquad
