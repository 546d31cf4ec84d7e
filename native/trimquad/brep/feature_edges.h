#pragma once

#include <vector>

#include "trimquad/mesh/feature_options.h"

// This order: OpenCASCADE's macros must not reach the mesh headers.
#include "trimquad/brep/cad_model.h"
#include "trimquad/brep/welded_mesh.h"

namespace trimquad {

/// The triangle (and which of its sides) on either hand of each side; free sides have one, sides nobody uses
/// none.
using SideUses = std::vector<std::vector<std::pair<int, int>>>;

/// Throws Error(Input) naming an edge where three or more faces meet.
SideUses sideUses(const CadModel& model, const WeldedMesh& mesh);

/// Turns faces over so that all agree across their common edges: closed groups point outward, others keep the
/// orientation that most of their area has. The triangles of faces turned over are reversed.
/// Returns per face whether its outside is against its surface's own normal.
/// Throws Error(Input) where that is impossible (a Moebius strip).
std::vector<char> orientFaces(const CadModel& model, WeldedMesh& mesh);

struct FeatureEdges {
  /// By CAD edge: whether the surface is opened there. Free edges; sharp ones that separate regions; and
  /// inner ones.
  std::vector<char> cut;
  /// By CAD edge: whether it is cut only for its vertices to be the same on both sides, and lies inside a
  /// region in the end: aligned, or one along which the region bends sharply.
  std::vector<char> inner;
  /// By CAD edge: whether grid lines must run along it.
  std::vector<char> aligned;
  /// By CAD edge: the same for inner ones, if they separated regions.
  std::vector<char> alignedAsBorder;
  /// By side of the welded mesh: whether the surface turns by more than the feature angle within `reach`
  /// (model units) to both sides of it, on an edge that separates no regions and is not aligned. Triangles of
  /// about that size must not reach across, so these edges are inner ones.
  std::vector<char> crease;
};

/// What the options make of a model's edges. An edge is sharp where the angle between the true normals of its
/// two faces exceeds the feature angle on most of its length; chains of sharp edges that end inside a region
/// do not separate anything and are aligned instead of cut. Throws Error(Input, "options") for names of edges
/// that are not there.
FeatureEdges featureEdges(const CadModel& model, const WeldedMesh& mesh, const SideUses& uses,
                          const std::vector<char>& reversed, const FeatureOptions& options, double reach);

/// Makes CAD edges such that separate regions.
void cutAlong(FeatureEdges& features, const WeldedMesh& mesh, const std::vector<int>& edges);

/// By vertex of the welded mesh: whether the options name it. Throws Error(Input, "options") for names of
/// vertices that are not there.
std::vector<char> featureVertices(const CadModel& model, const WeldedMesh& mesh,
                                  const FeatureOptions& options);

}  // namespace trimquad
