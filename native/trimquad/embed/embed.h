#pragma once

#include <functional>

#include "trimquad/base/progress.h"
#include "trimquad/embed/embedded_tmesh.h"
#include "trimquad/quantize/quantize.h"

namespace trimquad {

/// The T-mesh of a map laid along the edges of its mesh so that arcs of quantized length zero are points and
/// patches of quantized area zero are gone (paper, section 6.1): what is left are patches that are rectangles
/// of positive integer size, each a disk of triangles. The mesh is refined where that is necessary; critical
/// nodes, aligned edges and the boundary stay where they are. The arcs' homotopy classes are those of the
/// map. The lengths must be separating, as `quantize` promises. \param afterOperation  called before
/// the first operator and after each, for tests
EmbeddedTMesh embed(const Parametrization& map, const TMesh& tmesh, const Quantization& quantization,
                    const Progress& progress,
                    const std::function<void(const EmbeddedTMesh&)>& afterOperation = {});

}  // namespace trimquad
