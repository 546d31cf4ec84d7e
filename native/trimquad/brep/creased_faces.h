#pragma once

#include <ShapeBuild_ReShape.hxx>
#include <TopoDS_Shape.hxx>

namespace trimquad {

/// A shape whose faces were divided, and what became of the elements of the one before.
struct DividedShape {
  TopoDS_Shape shape;
  Handle(ShapeBuild_ReShape) history;
};

/// The shape with its faces divided along the lines of constant parameter at which their surfaces have
/// creases: knots of splines of continuity C0 only, as in many IGES files, or corners of a swept curve. Faces
/// that share an edge still share what becomes of it. Without a shape where no face has a crease, or
/// OpenCASCADE cannot divide those that have. (after ShapeUpgrade_ShapeDivideContinuity, which also divides
/// where tangents differ in length only)
DividedShape dividedAtCreases(const TopoDS_Shape& shape);

}  // namespace trimquad
