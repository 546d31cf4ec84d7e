#pragma once

#include <memory>
#include <vector>

#include "trimquad/mesh/true_surface.h"

// This order: OpenCASCADE's macros must not reach the mesh headers.
#include "trimquad/brep/cad_model.h"
#include "trimquad/brep/welded_mesh.h"

namespace trimquad {

/// The surface made up of the CAD faces under some triangles of a welded mesh.
/// The nearest triangle gives the face and where Newton's method starts on its surface; the foot point stays
/// near that triangle.
/// \param triangles indices into mesh.triangles
/// \param reversed  per face, whether the outside is against the surface's own normal
std::shared_ptr<const TrueSurface> cadSurface(const CadModel& model, const WeldedMesh& mesh,
                                              const std::vector<int>& triangles,
                                              const std::vector<char>& reversed);

}  // namespace trimquad
