#pragma once

#include <string>
#include <vector>

#include "trimquad/brep/shape.h"
#include "trimquad/spline/spline_model.h"

namespace trimquad {

/// The model as a boundary representation: faces that share their edges, in shells, closed ones that bound a
/// solid of the input in solids (turned outward), all in one compound unless there is a single one. Nothing
/// is sewn, moved or re-approximated; tolerances are the model's own, measured ones. Throws Error(Stage,
/// "write") where OpenCASCADE cannot hold a curve or surface.
Shape assemble(const SplineModel& model);

/// The faces of `assemble`'s shape in the model's order. They share their edges.
std::vector<Shape> assembledFaces(const SplineModel& model);

/// By face of `assemble`'s shape, as OpenCASCADE counts them (Face1, Face2, ..): its index in the model.
std::vector<int> faceOrder(const SplineModel& model);

/// What is looked for in a shape.
struct FaultKinds {
  bool elements = true;       ///< faults of its vertices, edges and faces: validity, continuity, small edges
  bool crossings = true;      ///< elements that cross others
  bool selfCrossings = true;  ///< faces that cross themselves; only with `crossings`
};

/// What is wrong with the shape, one line each ("Edge7: InvalidCurveOnSurface"), empty where nothing is:
/// OpenCASCADE's validity check, and its check of arguments for boolean operations (self-interference, small
/// edges, continuity, curves on surfaces), as FreeCAD's "Check geometry" runs them.
/// It can take minutes, or not end at all; see Checker.
std::vector<std::string> faults(const Shape& shape, FaultKinds kinds = {});

/// The shape as STEP AP242 in millimetres, with the curves on the surfaces. The same shape gives the same
/// text: the header carries a fixed date.
std::string stepText(const Shape& shape);

/// Writes stepText(). Throws Error(Input, "write") where the file cannot be written whole.
void writeStep(const Shape& shape, const std::string& path);

/// Writes OpenCASCADE's .brep. Throws Error(Input, "write") where the file cannot be written whole.
void writeBrep(const Shape& shape, const std::string& path);

}  // namespace trimquad
