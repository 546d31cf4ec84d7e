#pragma once

#include <optional>
#include <vector>

#include "trimquad/embed/insert_arcs.h"

namespace trimquad {

/// A node between two virtual arcs.
struct VirtualNode {
  std::optional<VertexHandle> fixed;  ///< it has this place on the segment already
  Eigen::Vector3d goal;               ///< otherwise it comes to lie near here
};

/// Distributes the nodes of a red segment's virtual arcs over the vertices of its path, in order and with the
/// least sum of squared distances (paper, section 6.1.1). The segment's edges are split where it has too few
/// vertices.
/// \return indices in `path`, ascending, between its ends; by node
std::vector<std::size_t> placeVirtualNodes(const SurfaceMesh& input, RefinedMesh& refined,
                                           const std::vector<VirtualNode>& nodes, EdgePath& path,
                                           int& splits);

}  // namespace trimquad
