#include "trimquad/embed/embed.h"

#include "trimquad/base/error.h"
#include "trimquad/embed/snap.h"
#include "trimquad/embed/virtual_nodes.h"
#include "trimquad/embed/zero_collapse.h"

namespace trimquad {
namespace {

int snapCut(const SurfaceMesh& input, RefinedMesh& surface, ArcPaths& cut) {
  std::vector<VertexHandle*> nodes;
  for (auto& node : cut.node)
    if (node) nodes.push_back(&*node);
  std::vector<EdgePath*> paths;
  for (auto& path : cut.arc)
    if (!path.empty()) paths.push_back(&path);
  for (auto& path : cut.redSegment) paths.push_back(&path);
  return snap(input, surface, nodes, paths);
}

/// Gives virtual nodes their vertices and virtual arcs their paths.
void embedVirtualArcs(const SurfaceMesh& input, const TMesh& tmesh, RefinedMesh& surface, ArcPaths& cut,
                      int& splits) {
  for (std::size_t r = 0; r < tmesh.redSegments.size(); ++r) {
    const auto& arcs = tmesh.redSegments[r].virtualArcs;
    EdgePath& path = cut.redSegment[r];
    std::vector<VirtualNode> nodes;
    for (std::size_t k = 0; k + 1 < arcs.size(); ++k) {
      const NodeId n = tmesh.end(arcs[k]);
      nodes.push_back({cut.node[n.index], tmesh[n].position});
    }
    const auto places = placeVirtualNodes(input, surface, nodes, path, splits);
    std::size_t from = 0;
    for (std::size_t k = 0; k < arcs.size(); ++k) {
      const std::size_t to = k < places.size() ? places[k] : path.size() - 1;
      TRIMQUAD_ASSERT(arcs[k].forward);
      cut.arc[arcs[k].arc.index].assign(path.begin() + long(from), path.begin() + long(to) + 1);
      if (k < places.size()) cut.node[tmesh.end(arcs[k]).index] = path[to];
      from = to;
    }
  }
}

void assemble(const TMesh& tmesh, const Quantization& quantization, ArcPaths cut, EmbeddedTMesh& embedded) {
  for (std::size_t n = 0; n < tmesh.nodes.size(); ++n) {
    TRIMQUAD_ASSERT(cut.node[n]);
    embedded.nodes.push_back({*cut.node[n], tmesh.nodes[n].critical, false});
    embedded.nodeOf.push_back(NodeId{int(n)});
  }
  for (std::size_t a = 0; a < tmesh.arcs.size(); ++a) {
    const auto& arc = tmesh.arcs[a];
    const bool onCurve = arc.border || arc.critical;
    embedded.arcs.push_back(
        {arc.from, arc.to, quantization.length[a], arc.border, onCurve, std::move(cut.arc[a])});
    if (onCurve)
      for (const NodeId n : {arc.from, arc.to}) embedded.nodes[n.index].onCurve = true;
  }
  for (const auto& patch : tmesh.patches) embedded.patches.push_back({patch.sides});
}

/// Numbers without gaps.
template <typename Id, typename Item>
std::vector<Id> withoutRemoved(std::vector<Item>& items) {
  std::vector<Id> renamed;
  std::vector<Item> kept;
  for (auto& item : items) {
    renamed.push_back(Id{int(kept.size())});
    if (!item.removed) kept.push_back(std::move(item));
  }
  items = std::move(kept);
  return renamed;
}

void dropRemoved(EmbeddedTMesh& embedded) {
  const auto node = withoutRemoved<NodeId>(embedded.nodes);
  const auto arc = withoutRemoved<ArcId>(embedded.arcs);
  withoutRemoved<PatchId>(embedded.patches);
  for (auto& a : embedded.arcs) a.from = node[a.from.index], a.to = node[a.to.index];
  for (auto& patch : embedded.patches)
    for (auto& side : patch.sides)
      for (HalfArc& h : side) h.arc = arc[h.arc.index];
  for (NodeId& n : embedded.nodeOf) n = node[n.index];
}

void snapEmbedded(const SurfaceMesh& input, EmbeddedTMesh& embedded) {
  std::vector<VertexHandle*> nodes;
  for (auto& node : embedded.nodes) nodes.push_back(&node.vertex);
  std::vector<EdgePath*> paths;
  for (auto& arc : embedded.arcs) paths.push_back(&arc.path);
  snap(input, embedded.surface, nodes, paths);
  const auto renamed = compact(embedded.surface);
  for (VertexHandle* node : nodes) *node = renamed[node->idx()];
  for (EdgePath* path : paths)
    for (VertexHandle& v : *path) v = renamed[v.idx()];
}

}  // namespace

EmbeddedTMesh embed(const Parametrization& map, const TMesh& tmesh, const Quantization& quantization,
                    const Progress& progress,
                    const std::function<void(const EmbeddedTMesh&)>& afterOperation) {
  const SurfaceMesh& input = map.mesh;
  EmbeddedTMesh embedded;
  RefinedMesh& surface = embedded.surface;
  EmbeddedTMesh::Counters& counters = embedded.counters;
  ArcPaths cut = insertArcs(map, tmesh, surface);
  counters.crossings = cut.crossings;
  counters.snapped = cut.crossings - int(surface.mesh.n_vertices() - input.n_vertices());
  progress.report(0.3);
  counters.snapped += snapCut(input, surface, cut);
  progress.report(0.5);
  embedVirtualArcs(input, tmesh, surface, cut, counters.splits);
  assemble(tmesh, quantization, std::move(cut), embedded);
  if (afterOperation) afterOperation(embedded);
  collapseZeros(input, embedded, progress, afterOperation);
  dropRemoved(embedded);
  progress.report(0.8);
  snapEmbedded(input, embedded);
  relax(input, surface);
  counters.inserted = int(surface.mesh.n_vertices() - input.n_vertices());
  verify(embedded);
  return embedded;
}

}  // namespace trimquad
