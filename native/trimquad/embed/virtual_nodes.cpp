#include "trimquad/embed/virtual_nodes.h"

#include <algorithm>
#include <limits>

#include "trimquad/base/error.h"
#include "trimquad/mesh/collapse_edge.h"

namespace trimquad {
namespace {

/// Splits the longest edge of the path between the vertices `from` and `to`.
void splitLongest(const SurfaceMesh& input, RefinedMesh& refined, EdgePath& path, std::size_t from,
                  std::size_t to) {
  const auto length = [&](std::size_t k) {
    return (refined.mesh.point(path[k]) - refined.mesh.point(path[k + 1])).squaredNorm();
  };
  std::size_t longest = from;
  for (std::size_t k = from; k < to; ++k)
    if (length(k) > length(longest)) longest = k;
  const HalfedgeHandle h = halfedgeBetween(refined.mesh, path[longest], path[longest + 1]);
  TRIMQUAD_ASSERT(h.is_valid());
  const VertexHandle v = splitInMiddle(input, refined, refined.mesh.edge_handle(h));
  path.insert(path.begin() + long(longest) + 1, v);
}

/// The path gets as many vertices between fixed nodes and its ends as there are nodes to place.
void refine(const SurfaceMesh& input, RefinedMesh& refined, const std::vector<VirtualNode>& nodes,
            EdgePath& path, int& splits) {
  std::size_t from = 0, waiting = 0;
  for (std::size_t n = 0; n <= nodes.size(); ++n) {
    if (n < nodes.size() && !nodes[n].fixed) {
      ++waiting;
      continue;
    }
    std::size_t to = path.size() - 1;
    if (n < nodes.size())
      to = std::size_t(std::find(path.begin() + long(from) + 1, path.end() - 1, *nodes[n].fixed) -
                       path.begin());
    TRIMQUAD_ASSERT(n == nodes.size() || path[to] == *nodes[n].fixed);
    for (; to - from - 1 < waiting; ++to, ++splits) splitLongest(input, refined, path, from, to);
    from = to;
    waiting = 0;
  }
}

}  // namespace

std::vector<std::size_t> placeVirtualNodes(const SurfaceMesh& input, RefinedMesh& refined,
                                           const std::vector<VirtualNode>& nodes, EdgePath& path,
                                           int& splits) {
  refine(input, refined, nodes, path, splits);
  // cost[k]: of the nodes so far, the last of them in path[k].
  constexpr double kNever = std::numeric_limits<double>::infinity();
  std::vector<double> cost(path.size(), kNever);
  cost[0] = 0;
  std::vector<std::vector<std::size_t>> before;
  for (const VirtualNode& node : nodes) {
    std::vector<double> next(path.size(), kNever);
    before.emplace_back(path.size(), 0);
    std::size_t best = 0;
    for (std::size_t k = 1; k + 1 < path.size(); ++k) {
      if (cost[k - 1] < cost[best]) best = k - 1;
      if (node.fixed && path[k] != *node.fixed) continue;
      next[k] = cost[best] + (node.fixed ? 0 : (refined.mesh.point(path[k]) - node.goal).squaredNorm());
      before.back()[k] = best;
    }
    cost = std::move(next);
  }
  std::vector<std::size_t> places(nodes.size());
  std::size_t k = std::size_t(std::min_element(cost.begin(), cost.end()) - cost.begin());
  TRIMQUAD_ASSERT(cost[k] < kNever);
  for (std::size_t n = nodes.size(); n-- > 0; k = before[n][k]) places[n] = k;
  return places;
}

}  // namespace trimquad
