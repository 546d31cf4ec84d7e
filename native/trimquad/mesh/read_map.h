#pragma once

#include <string>

#include "trimquad/mesh/parametrization.h"

namespace trimquad {

/// The map that `writeObj` wrote: `v`, `vt`, `f v/vt`, then `l i j` for aligned edges and `p i` for feature
/// points. Its coordinates must be whole numbers of quanta of the finest scale that they fit, so that seams
/// are exact; then the result is the same map, perhaps in another scale. \param name for error messages
/// Throws Error(Input, "read") naming the line, or Error(Input) where the triangles are no oriented manifold.
Parametrization readMapObj(const std::string& name, const std::string& text);

}  // namespace trimquad
