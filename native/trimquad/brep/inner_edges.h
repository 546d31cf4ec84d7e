#pragma once

#include "trimquad/brep/cad_model.h"
#include "trimquad/brep/feature_edges.h"
#include "trimquad/brep/welded_mesh.h"

namespace trimquad {

/// Divides inner edges (FeatureEdges::inner) that are one side of the mesh only: opened along it between two
/// vertices of its own region, a surface would have the same edge twice. Vertices and sides keep their
/// numbers, triangles change; `features.crease` grows along.
void divideInnerEdges(const CadModel& model, WeldedMesh& mesh, FeatureEdges& features);

}  // namespace trimquad
