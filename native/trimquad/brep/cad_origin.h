#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "trimquad/mesh/divide_curves.h"
#include "trimquad/mesh/feature_options.h"
#include "trimquad/mesh/region.h"

// This order: OpenCASCADE's macros must not reach the mesh headers.
#include "trimquad/brep/cad_model.h"
#include "trimquad/brep/feature_edges.h"
#include "trimquad/brep/welded_mesh.h"

namespace trimquad {

/// A CAD shape in triangles, before it is cut.
struct WeldedShape {
  CadModel cad;
  WeldedMesh mesh;
  SideUses uses;
  std::vector<char> reversed;  ///< by face: whether its outside is against its surface's own normal
  std::vector<char> points;    ///< by vertex of the mesh: whether it becomes a feature point
};

/// What the regions of a CAD model were cut from, so that they can be cut further.
struct CadOrigin {
  std::shared_ptr<const WeldedShape> shape;
  FeatureEdges features;  ///< with all cuts that were made
  RemeshOptions remeshing;
  double quadLength;                        ///< FeatureOptions::quadLength
  std::vector<std::vector<int>> triangles;  ///< by region of the model: triangles of the welded mesh
  /// By CAD edge: where it is divided, both ends included; empty where no region ends.
  std::vector<std::vector<double>> division;
  std::vector<std::optional<CurveId>> curve;    ///< by CAD edge: the model's
  std::vector<std::optional<CornerId>> corner;  ///< by CAD vertex: the model's
};

}  // namespace trimquad
