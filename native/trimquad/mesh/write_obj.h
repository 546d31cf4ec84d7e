#pragma once

#include <string>

#include "trimquad/mesh/parametrization.h"

namespace trimquad {

/// A map as Wavefront OBJ: `v` in model units, `vt` in quads, one for each distinct image of a vertex, so
/// that cuts are where the two faces of an edge use different ones; triangles `f v/vt`; then, where there are
/// any, `g aligned` with an `l i j` for each aligned edge and `g feature` with a `p i` for each feature
/// point. 17 significant digits: reading the text gives the same doubles, and the doubles are the exact
/// coordinates.
std::string writeObj(const Parametrization& map);

}  // namespace trimquad
