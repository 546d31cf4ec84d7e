#include "trimquad/mesh/feature_graph.h"

#include <algorithm>
#include <numbers>

namespace trimquad {
namespace {

constexpr double kCornerAngle = std::numbers::pi / 4;

}  // namespace

int FeatureGraph::count(Node kind) const {
  return int(std::count(node.begin(), node.end(), kind));
}

FeatureGraph featureGraph(const Region& region) {
  const auto& mesh = region.mesh;
  std::vector<bool> aligned(mesh.n_edges(), false);
  std::vector<int> degree(mesh.n_vertices(), 0);
  for (const auto e : region.aligned) {
    aligned[e.idx()] = true;
    for (const int side : {0, 1}) ++degree[mesh.to_vertex_handle(mesh.halfedge_handle(e, side)).idx()];
  }
  const BorderGraph border(mesh, std::move(aligned), kCornerAngle);
  FeatureGraph graph{border.chains(), {}};
  graph.node.resize(mesh.n_vertices());
  for (const auto v : region.featurePoints) graph.node[v.idx()] = FeatureGraph::Node::Point;
  for (const auto v : mesh.vertices()) {
    if (!border.isCorner(v)) continue;
    graph.node[v.idx()] = degree[v.idx()] == 1   ? FeatureGraph::Node::End
                          : degree[v.idx()] == 2 ? FeatureGraph::Node::Corner
                                                 : FeatureGraph::Node::Junction;
  }
  return graph;
}

}  // namespace trimquad
