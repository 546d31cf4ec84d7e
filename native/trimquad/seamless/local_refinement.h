#pragma once

#include "trimquad/mesh/refined_mesh.h"
#include "trimquad/seamless/map_energy.h"

namespace trimquad {

/// These triangles and the ones within so many rings around them. Ascending.
std::vector<FaceHandle> within(const SurfaceMesh& mesh, const std::vector<FaceHandle>& triangles, int rings);

/// The edges of these triangles, the longest first, so that halving them one after the other leaves no
/// needles.
std::vector<EdgeHandle> edgesOf(const SurfaceMesh& mesh, const std::vector<FaceHandle>& triangles);

/// The same field on a refined mesh: new vertices are regular.
CrossField refinedField(const SurfaceMesh& mesh, const RefinedMesh& refined, const CrossField& field);

/// The same guidance on a refined mesh.
FieldGuidance refinedGuidance(const RefinedMesh& refined, const FieldGuidance& guidance);

}  // namespace trimquad
