#pragma once

#include <string>
#include <vector>

#include "trimquad/mesh/region.h"

namespace trimquad {

/// Chosen edges of a mesh model, from names like "loop:2", "loop:2/1", "feature:0" and "angle:40-180"
/// (FeatureOptions). `curve` is by edge of the whole mesh.
///
/// Returns by edge whether one of the names means it. Throws Error(Input, "options"), with the names that
/// there are, for one that means nothing.
std::vector<bool> chosenEdges(const SurfaceMesh& mesh, const std::vector<ModelCurve>& curves,
                              const std::vector<std::optional<CurveId>>& curve,
                              const std::vector<std::string>& names);

/// "loop:2/1" for the second piece of a loop of several, otherwise the curve's own name. By curve.
std::vector<std::string> pieceNames(const std::vector<ModelCurve>& curves);

}  // namespace trimquad
