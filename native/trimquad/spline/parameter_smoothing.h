#pragma once

#include <Eigen/Core>

#include <array>
#include <optional>
#include <vector>

namespace trimquad {

/// Averages the moves of samples' parameters, from the map's to their feet, with those of their neighbours,
/// over about the knot interval that four of them share. Feet alone crowd and leave gaps beside bends that
/// knots cannot follow, and a surface through them folds there.
///
/// \param cells small triangles between samples
/// \param chart by sample: in whose plane its move is; none where it has none
/// \param held  by sample: whether its move stays
/// \param moves by sample, quads
void smoothMoves(const std::vector<std::array<int, 3>>& cells, const std::vector<std::optional<int>>& chart,
                 const std::vector<char>& held, std::vector<Eigen::Vector2d>& moves);

}  // namespace trimquad
