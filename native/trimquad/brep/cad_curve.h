#pragma once

#include <memory>

#include "trimquad/mesh/true_surface.h"

// This order: OpenCASCADE's macros must not reach the mesh headers.
#include "trimquad/brep/cad_model.h"

namespace trimquad {

/// The curve of a CAD edge over its whole range; the curve on its surface where it has none in space.
/// Throws Error(Input, "tessellate") for an edge without any curve.
std::shared_ptr<const TrueCurve> cadCurve(const CadEdge& edge);

}  // namespace trimquad
