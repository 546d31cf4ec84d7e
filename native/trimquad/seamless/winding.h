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

/// Lays the fans of triangles around `centers` out anew, each evenly around its vertex's image: angles as on
/// the surface, stretched to what the cone asks for, lengths and mean direction as in the target. The centers
/// stay where they are.
void spreadFans(const std::vector<VertexHandle>& centers, const SurfaceMesh& mesh, const SeamGraph& seams,
                const MapTarget& target, const std::vector<int>& index, const SeamBasis& basis,
                Eigen::VectorXd& z);

/// Makes the map z harmonic within so many rings around `centers`, and leaves it as it is elsewhere.
void relaxAround(const std::vector<VertexHandle>& centers, int rings, const SurfaceMesh& mesh,
                 const MapEnergy& energy, const SeamBasis& basis, Eigen::VectorXd& z);

}  // namespace trimquad
