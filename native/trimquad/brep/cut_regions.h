#pragma once

#include <vector>

#include "trimquad/mesh/remesh.h"

// This order: OpenCASCADE's macros must not reach the mesh headers.
#include "trimquad/brep/cad_origin.h"

namespace trimquad {

struct CutModel {
  Model model;
  std::vector<char> inner;      ///< by curve: whether regions are to be joined again across it
  std::vector<char> aligned;    ///< by curve
  std::vector<int> cadEdge;     ///< by curve
  std::vector<int> cadVertex;   ///< by corner
  /// Of the regions after joining, in the order of their first parts.
  std::vector<std::shared_ptr<const TrueSurface>> surfaces;
  std::vector<std::vector<int>> triangles;  ///< of the welded mesh
};

/// Triangles of a welded mesh cut open along the feature edges, with their curves, corners and shells. The
/// regions' meshes are BRepMesh's triangles; boundary vertices lie on their curves.
/// \param triangles  indices into the welded mesh, ascending; neighbours across edges that are not cut are
/// there
CutModel cutRegions(const WeldedShape& shape, const FeatureEdges& features,
                    const std::vector<int>& triangles);

}  // namespace trimquad
