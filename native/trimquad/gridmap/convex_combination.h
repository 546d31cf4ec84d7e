#pragma once

#include <optional>
#include <vector>

#include "trimquad/gridmap/patch_disk.h"

namespace trimquad {

/// Positive weights of the disk's edges, by triangle and corner k: of the edge from corner k to the next one
/// and of the edge back from there, as far as they come from this triangle.
using EdgeWeights = std::vector<std::array<std::array<double, 2>, 3>>;

/// Mean-value weights (Floater 2003) of triangles with these corners; none where a triangle is too thin for
/// them.
std::optional<EdgeWeights> meanValueWeights(const std::vector<std::array<Eigen::Vector2d, 3>>& shapes);

EdgeWeights uniformWeights(std::size_t triangles);

/// Every inner vertex in the weighted mean of its neighbours, rim vertices where they are given (Tutte 1963).
/// The map is one to one if the rim goes once around a convex polygon and no inner edge joins two points of
/// one side. \return by vertex of the disk, as many as can be solved for in doubles; nothing where the system
/// is singular in these
std::optional<std::vector<Eigen::Vector2d>> convexCombinationMap(const PatchDisk& disk,
                                                                 const EdgeWeights& weights,
                                                                 const std::vector<Eigen::Vector2d>& rim);

}  // namespace trimquad
