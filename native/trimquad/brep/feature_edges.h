#pragma once

#include <vector>

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
  /// By CAD edge: whether regions end there. Free edges, and edges where the angle between the true normals
  /// of their two faces exceeds `angle` on most of their length; without sharp chains that end inside a
  /// region and separate nothing.
  std::vector<char> cut;
  /// By side of the welded mesh: whether the surface turns by more than `angle` within `reach` (model units)
  /// to both sides of it, on an edge that is not cut. Triangles of about that size must not reach across.
  std::vector<char> crease;
};

/// \param angle  radians; with an infinite one only free edges count
FeatureEdges featureEdges(const CadModel& model, const WeldedMesh& mesh, const SideUses& uses,
                          const std::vector<char>& reversed, double angle, double reach);

}  // namespace trimquad
