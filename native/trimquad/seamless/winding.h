#pragma once

#include <vector>

#include "trimquad/seamless/map_energy.h"
#include "trimquad/seamless/seamless_map.h"

namespace trimquad {

/// The interior vertices that the map x winds around more or less often than their index says. Positive
/// triangles alone do not exclude that: a fan can wind around its vertex twice.
std::vector<VertexHandle> wrongCones(const SurfaceMesh& mesh, const std::vector<int>& index,
                                     const SeamBasis& basis, const Eigen::VectorXd& x);

/// The same, and the corners of flipped triangles.
std::vector<VertexHandle> troubled(const SurfaceMesh& mesh, const std::vector<int>& index,
                                   const SeamBasis& basis, const MapEnergy& energy, const Eigen::VectorXd& x);

/// The triangles that a map x turns over or collapses, and those around vertices that it winds around too
/// often or too rarely. Ascending.
std::vector<FaceHandle> wrongTriangles(const SurfaceMesh& mesh, const std::vector<int>& index,
                                       const SeamBasis& basis, const MapEnergy& energy,
                                       const Eigen::VectorXd& x);

}  // namespace trimquad
