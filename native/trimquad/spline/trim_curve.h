#pragma once

#include <string>
#include <vector>

#include "trimquad/base/progress.h"
#include "trimquad/mesh/region.h"
#include "trimquad/spline/boundary_runs.h"
#include "trimquad/spline/intersection_curve.h"
#include "trimquad/spline/sheet.h"

namespace trimquad {

/// Largest distance, model units, that an edge's curve is given from its image on a surface: so little that
/// OpenCASCADE and STEP keep the tolerance 1e-7.
inline constexpr double kComposedError = 2e-8;

/// One sheet that ends on a model curve.
struct SheetSide {
  const Sheet* sheet;
  const BoundaryRun* run;
  std::string region;          ///< its name, for errors
  Eigen::Vector2d start, end;  ///< places of the vertices at the curve's ends, unwrapped; set by the caller
};

/// A model curve, sampled, with the feet of the samples on the sheets that end there.
struct SampledCurve {
  const ModelCurve* curve;
  std::vector<double> t, s;  ///< the curve's own parameter; chord length from the start
  std::vector<Eigen::Vector3d> point;
  std::vector<std::vector<Eigen::Vector2d>> foot;  ///< by side, by sample

  /// Chord length from the start to the curve's point at parameter `at`.
  double lengthAt(double at) const;
  /// How far the feet of a sample on both sides are from each other at most.
  double apart(const std::vector<SheetSide>& sides) const;
};

/// Samples between all neighbouring boundary vertices. Throws Error(Stage, "fit") where a sheet is further
/// away than `reach`.
SampledCurve sampleCurve(const ModelCurve& curve, const std::vector<SheetSide>& sides, double reach);

/// An edge to be: its curve in space and on each side's sheet, all with the same parameter.
struct TrimPiece {
  SpaceCurve curve;
  std::vector<PlaneCurve> onSheet;  ///< by side, unwrapped
  double gap;                       ///< largest distance between the curve and its images on the sheets
};

/// How far an edge may be from its model curve, model units: everywhere as far as `onSheet`, as seen on the
/// sheet; where that is more, as far as `inSpace`, the curve's distance from the sheet included.
struct CurveCloseness {
  double onSheet, inSpace;
};

/// Pieces of the edge of one sheet, in order: they follow the model curve closely enough, start and end in
/// `side.start` and `side.end`, and are cut wherever they cross the sheet's seam.
std::vector<TrimPiece> freeEdge(const SampledCurve& sampled, const SheetSide& side,
                                const CurveCloseness& closeness, const Progress& progress);

/// The curve in which two sheets cut each other along a model curve; null where the sine of the angle between
/// them is below `smallestAngle`, in the ends as well, but for tangent stretches.
std::optional<IntersectionCurve> intersectionCurve(const SampledCurve& sampled,
                                                   const std::vector<SheetSide>& sides, double tolerance,
                                                   double reach, double smallestAngle,
                                                   const std::vector<TangentStretch>& tangent,
                                                   const Progress& progress);

/// Pieces of the intersection curve between the points nearest to `start` and `end`, cut at both sheets'
/// seams. It ends in these points, and on the sheets where the sides end, unless these are too far off for
/// its last piece to be led there: so that all edges of a sheet end in one place, which readers of STEP ask
/// for. Null where it has a gap after all. \param sides of both sheets; only their ends count
std::optional<std::vector<TrimPiece>> sharedEdge(const IntersectionCurve& intersection, bool closed,
                                                 const Eigen::Vector3d& start, const Eigen::Vector3d& end,
                                                 const std::vector<SheetSide>& sides,
                                                 const Progress& progress);

/// Makes an edge with a gap between `exact` and `most` farthest from its sheets at its start, by moving its
/// curve's first pole away from them by a quarter more than its gap. STEP has no tolerances of edges: readers
/// look for the distance at a few places, the ends among them, and take the edge for faulty if it is more
/// between these, or follow it on the sheets by curves of their own, which are worse.
void exposeGap(TrimPiece& piece, const std::vector<SheetSide>& sides, double exact, double most);

/// Pieces of an edge on the first side's sheet, which the second sheet only touches within the gap: for
/// sheets that are nearly tangent.
std::vector<TrimPiece> looseEdge(const SampledCurve& sampled, const std::vector<SheetSide>& sides,
                                 double closeness, const Progress& progress);

}  // namespace trimquad
