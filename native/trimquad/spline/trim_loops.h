#pragma once

#include <string>
#include <vector>

#include "trimquad/spline/sheet.h"
#include "trimquad/spline/spline_model.h"

namespace trimquad {

/// An edge as a boundary loop of a region uses it, before the parameter plane is cut at a seam.
struct LoopPiece {
  SplineCoedge coedge;        ///< its curve unwrapped over the seam
  SplineVertexId start, end;  ///< in the direction of the loop
};
using PieceLoop = std::vector<LoopPiece>;

/// The faces that the loops, with the region on their left, bound on the sheet; `region` names them in
/// errors. A closed sheet is cut along its seam: iso-curves between neighbouring crossings of the loops with
/// the seam become edges of `model`, each used twice, and what falls apart becomes faces of its own. Throws
/// Error(Stage, "fit") where the loops bound nothing.
std::vector<SplineFace> trimmedFaces(const Sheet& sheet, const std::vector<PieceLoop>& loops, int region,
                                     const std::string& name, SplineModel& model);

/// The loop as a polygon in the parameter plane, in its direction.
std::vector<Eigen::Vector2d> loopPolygon(const std::vector<SplineCoedge>& loop);

/// A point where loops of the face cross each other or themselves, as polygons; null where none does.
std::optional<Eigen::Vector2d> loopCrossing(const SplineFace& face);

/// Where to cut a closed sheet: `u` in its domain that the boundary crosses least often, away from corners
/// and from places where the boundary turns back. \param boundary stretches from corner to corner, unwrapped
double seamPlace(const Sheet& sheet, const std::vector<std::vector<Eigen::Vector2d>>& boundary);

}  // namespace trimquad
