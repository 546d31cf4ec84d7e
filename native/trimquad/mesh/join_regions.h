#pragma once

#include <vector>

#include "trimquad/mesh/region.h"

namespace trimquad {

/// Joins regions across curves on which both sides have the same vertices. Those curves leave the model; the
/// other curves keep their order.
///
/// \param inner     by curve: whether regions are joined across it; two edges lie on each of its pieces
/// \param surfaces  of the joined regions; numbered as these are, by their first parts
/// Feature points, aligned edges and everything else that regions know is carried over.
Model joinRegions(const Model& parts, const std::vector<char>& inner,
                  const std::vector<std::shared_ptr<const TrueSurface>>& surfaces);

/// By region: the number of the joined region that it becomes part of, counted in the order of first parts.
std::vector<int> joinedRegions(const Model& parts, const std::vector<char>& inner);

}  // namespace trimquad
