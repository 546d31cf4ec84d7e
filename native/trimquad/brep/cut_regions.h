#pragma once

#include <vector>

#include "trimquad/mesh/remesh.h"

// This order: OpenCASCADE's macros must not reach the mesh headers.
#include "trimquad/brep/cad_model.h"
#include "trimquad/brep/feature_edges.h"
#include "trimquad/brep/welded_mesh.h"

namespace trimquad {

struct CutModel {
  Model model;
  std::vector<Creases> creases;  ///< by region
  std::vector<char> inner;       ///< by curve: whether regions are to be joined again across it
  std::vector<char> aligned;     ///< by curve
  /// Of the regions after joining, in the order of their first parts.
  std::vector<std::shared_ptr<const TrueSurface>> surfaces;
};

/// The welded mesh cut open along the feature edges, with its curves, corners and shells. The meshes are
/// BRepMesh's triangles; boundary vertices lie on their curves.
/// \param points  by vertex of the mesh: whether it becomes a feature point
CutModel cutRegions(const CadModel& cad, const WeldedMesh& mesh, const SideUses& uses,
                    const FeatureEdges& features, const std::vector<char>& points,
                    const std::vector<char>& reversed);

}  // namespace trimquad
