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

/// Per CAD edge, whether regions end there: free edges, and edges where the angle between the true normals of
/// their two faces, `reach` (model units) away from the edge, exceeds `angle` (radians) on most of their
/// length: a rounding that turns within the tolerance is an edge for all that the result can show. Without
/// sharp chains that end inside a region and separate nothing. With an infinite angle only free edges count.
std::vector<char> cutEdges(const CadModel& model, const WeldedMesh& mesh, const SideUses& uses,
                           const std::vector<char>& reversed, double angle, double reach);

}  // namespace trimquad
