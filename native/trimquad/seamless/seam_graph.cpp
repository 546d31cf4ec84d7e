#include "trimquad/seamless/seam_graph.h"

#include <queue>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

/// Fewest-edges path of interior edges from one boundary loop to another, through interior vertices where
/// there is one.
std::vector<HalfedgeHandle> pathBetween(const SurfaceMesh& mesh, const std::vector<HalfedgeHandle>& from,
                                        const std::vector<HalfedgeHandle>& to) {
  for (const bool throughBoundary : {false, true}) {
    std::vector<char> target(mesh.n_vertices(), 0), reached(mesh.n_vertices(), 0);
    std::vector<HalfedgeHandle> arrival(mesh.n_vertices());
    for (const auto h : to) target[mesh.from_vertex_handle(h).idx()] = 1;
    std::queue<VertexHandle> queue;
    for (const auto h : from) {
      queue.push(mesh.from_vertex_handle(h));
      reached[mesh.from_vertex_handle(h).idx()] = 1;
    }
    while (!queue.empty()) {
      const auto v = queue.front();
      queue.pop();
      for (const auto h : mesh.voh_range(v)) {
        const auto w = mesh.to_vertex_handle(h);
        if (reached[w.idx()] || mesh.is_boundary(mesh.edge_handle(h))) continue;
        if (!target[w.idx()] && mesh.is_boundary(w) && !throughBoundary) continue;
        reached[w.idx()] = 1;
        arrival[w.idx()] = h;
        if (target[w.idx()]) {
          std::vector<HalfedgeHandle> path;
          for (auto x = w; arrival[x.idx()].is_valid(); x = mesh.from_vertex_handle(arrival[x.idx()]))
            path.push_back(arrival[x.idx()]);
          return path;
        }
        queue.push(w);
      }
    }
  }
  throw stageError("seamless", "no path of edges joins the two ends of a tube; refine the mesh");
}

}  // namespace

SeamGraph seamGraph(const SurfaceMesh& mesh, const CrossField& field) {
  SeamGraph seams;
  seams.crossing.resize(mesh.n_halfedges());
  const auto loops = boundaryLoops(mesh);
  TRIMQUAD_ASSERT(loops.size() == field.loopTurns.size());
  std::vector<int> ends;
  for (int l = 0; l < int(loops.size()); ++l)
    if (field.loopTurns[l] == 0)
      ends.push_back(l);
    else if (field.loopTurns[l] == 1)
      seams.outerLoop = l;
  if (ends.empty()) return seams;
  TRIMQUAD_ASSERT(ends.size() == 2);
  seams.rotation.push_back(0);
  for (const auto h : pathBetween(mesh, loops[ends[0]], loops[ends[1]])) {
    seams.crossing[h.idx()] = SeamGraph::Crossing{0, true};
    seams.crossing[mesh.opposite_halfedge_handle(h).idx()] = SeamGraph::Crossing{0, false};
  }
  return seams;
}

}  // namespace trimquad
