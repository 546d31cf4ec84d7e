#include "trimquad/seamless/seam_graph.h"

#include <algorithm>
#include <cmath>
#include <queue>

#include "trimquad/base/disjoint_sets.h"
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

/// Whether the field has no singularity and turns around the loops as in a plane region with holes, or on a
/// tube: all maps of such a region can have one chart, or a single period.
bool isPlaneOrTube(const SurfaceMesh& mesh, const CrossField& field) {
  if (field.loopTurns.empty() || 2 - eulerCharacteristic(mesh) != int(field.loopTurns.size())) return false;
  for (const int index : field.index)
    if (index != 0) return false;
  const auto count = [&](int turns) {
    return std::count(field.loopTurns.begin(), field.loopTurns.end(), turns);
  };
  const auto others = std::ptrdiff_t(field.loopTurns.size()) - count(-4);
  return (others == 1 && count(4) == 1) || (others == 2 && count(0) == 2);
}

SeamGraph planeOrTubeSeams(const SurfaceMesh& mesh, const CrossField& field) {
  SeamGraph seams;
  seams.crossing.resize(mesh.n_halfedges());
  const auto loops = boundaryLoops(mesh);
  TRIMQUAD_ASSERT(loops.size() == field.loopTurns.size());
  std::vector<int> ends;
  for (int l = 0; l < int(loops.size()); ++l)
    if (field.loopTurns[l] == 0)
      ends.push_back(l);
    else if (field.loopTurns[l] == 4)
      seams.outerLoop = l;
  if (ends.empty()) return seams;
  TRIMQUAD_ASSERT(ends.size() == 2);
  seams.tube = true;
  seams.rotation.push_back(0);
  for (const auto h : pathBetween(mesh, loops[ends[0]], loops[ends[1]])) {
    seams.crossing[h.idx()] = SeamGraph::Crossing{0, true};
    seams.crossing[mesh.opposite_halfedge_handle(h).idx()] = SeamGraph::Crossing{0, false};
  }
  return seams;
}

/// Shortest paths along interior edges from the boundary, or from one vertex of a closed surface.
struct ShortestPaths {
  std::vector<double> distance;
  std::vector<HalfedgeHandle> arrival;  ///< by vertex: the halfedge by which its path enters it
};

ShortestPaths shortestPaths(const SurfaceMesh& mesh, const CrossField& field) {
  ShortestPaths paths{std::vector<double>(mesh.n_vertices(), INFINITY),
                      std::vector<HalfedgeHandle>(mesh.n_vertices())};
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  const auto start = [&](int v) {
    paths.distance[v] = 0;
    queue.emplace(0.0, v);
  };
  for (const auto v : mesh.vertices())
    if (mesh.is_boundary(v)) start(v.idx());
  if (queue.empty()) {
    const auto singular =
        std::find_if(field.index.begin(), field.index.end(), [](int index) { return index != 0; });
    start(singular == field.index.end() ? 0 : int(singular - field.index.begin()));
  }
  while (!queue.empty()) {
    const auto [d, v] = queue.top();
    queue.pop();
    if (d > paths.distance[v]) continue;
    for (const auto h : mesh.voh_range(VertexHandle(v))) {
      if (mesh.is_boundary(mesh.edge_handle(h))) continue;
      const int w = mesh.to_vertex_handle(h).idx();
      const double next = d + mesh.calc_edge_length(h);
      if (next >= paths.distance[w]) continue;
      paths.distance[w] = next;
      paths.arrival[w] = h;
      queue.emplace(next, w);
    }
  }
  return paths;
}

/// Edges, by index, along which the surface opens to a disk that has every singularity on its rim: what is
/// left of a tree of shortest paths and of a tree of triangles that avoids it, less the branches that lead
/// nowhere.
std::vector<char> cutEdges(const SurfaceMesh& mesh, const CrossField& field) {
  const ShortestPaths paths = shortestPaths(mesh, field);
  std::vector<char> inTree(mesh.n_edges(), 0), cut(mesh.n_edges(), 0);
  for (const auto h : paths.arrival)
    if (h.is_valid()) inTree[mesh.edge_handle(h).idx()] = 1;
  std::vector<std::pair<double, EdgeHandle>> others;  // by the length of the loop that the edge closes
  for (const auto e : mesh.edges()) {
    if (mesh.is_boundary(e) || inTree[e.idx()]) continue;
    const auto h = mesh.halfedge_handle(e, 0);
    others.emplace_back(mesh.calc_edge_length(e) + paths.distance[mesh.from_vertex_handle(h).idx()] +
                            paths.distance[mesh.to_vertex_handle(h).idx()],
                        e);
  }
  std::sort(others.begin(), others.end(), [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first > b.first : a.second.idx() < b.second.idx();
  });
  std::vector<VertexHandle> ends;
  DisjointSets triangles(mesh.n_faces());
  for (const auto& [length, e] : others) {
    const auto h = mesh.halfedge_handle(e, 0), o = mesh.halfedge_handle(e, 1);
    const int left = mesh.face_handle(h).idx(), right = mesh.face_handle(o).idx();
    if (triangles.root(left) != triangles.root(right)) {
      triangles.unite(left, right);
      continue;
    }
    cut[e.idx()] = 1;
    ends.push_back(mesh.to_vertex_handle(h));
    ends.push_back(mesh.to_vertex_handle(o));
  }
  for (const auto v : mesh.vertices())
    if (field.index[v.idx()] != 0) ends.push_back(v);
  for (auto v : ends)
    while (paths.arrival[v.idx()].is_valid()) {
      const auto h = paths.arrival[v.idx()];
      if (cut[mesh.edge_handle(h).idx()]) break;
      cut[mesh.edge_handle(h).idx()] = 1;
      v = mesh.from_vertex_handle(h);
    }
  return cut;
}

/// Orders the cut edges into branches.
SeamGraph branchesOf(const SurfaceMesh& mesh, const CrossField& field, const std::vector<char>& cut) {
  SeamGraph seams;
  seams.crossing.resize(mesh.n_halfedges());
  std::vector<int> degree(mesh.n_vertices(), 0);
  for (const auto h : mesh.halfedges())
    if (cut[mesh.edge_handle(h).idx()]) ++degree[mesh.from_vertex_handle(h).idx()];
  const auto isNode = [&](VertexHandle v) {
    return degree[v.idx()] != 2 || field.index[v.idx()] != 0 || mesh.is_boundary(v);
  };
  const auto follow = [&](HalfedgeHandle start) {
    const int branch = int(seams.rotation.size());
    seams.rotation.push_back(0);
    for (auto h = start;;) {
      seams.crossing[h.idx()] = SeamGraph::Crossing{branch, true};
      seams.crossing[mesh.opposite_halfedge_handle(h).idx()] = SeamGraph::Crossing{branch, false};
      const auto v = mesh.to_vertex_handle(h);
      if (isNode(v)) break;
      HalfedgeHandle next;
      for (const auto out : mesh.voh_range(v))
        if (cut[mesh.edge_handle(out).idx()] && !seams.crossing[out.idx()]) next = out;
      if (!next.is_valid()) break;  // a closed branch without a node
      h = next;
    }
  };
  for (const bool fromNode : {true, false})
    for (const auto h : mesh.halfedges())
      if (cut[mesh.edge_handle(h).idx()] && !seams.crossing[h.idx()] &&
          (!fromNode || isNode(mesh.from_vertex_handle(h))))
        follow(h);
  return seams;
}

/// Combs the field from triangle to triangle and reads the rotations of the branches off.
void comb(const SurfaceMesh& mesh, const CrossField& field, SeamGraph& seams) {
  seams.combing.assign(mesh.n_faces(), 0);
  std::vector<char> reached(mesh.n_faces(), 0);
  std::queue<FaceHandle> queue;
  queue.push(FaceHandle(0));
  reached[0] = 1;
  while (!queue.empty()) {
    const auto f = queue.front();
    queue.pop();
    for (const auto h : mesh.fh_range(f)) {
      const auto g = mesh.opposite_face_handle(h);
      if (!g.is_valid() || seams.crossing[h.idx()] || reached[g.idx()]) continue;
      reached[g.idx()] = 1;
      seams.combing[g.idx()] = (seams.combing[f.idx()] - field.matching[h.idx()]) & 3;
      queue.push(g);
    }
  }
  std::vector<char> known(seams.rotation.size(), 0);
  for (const auto h : mesh.halfedges()) {
    if (mesh.is_boundary(mesh.edge_handle(h))) continue;
    const int rotation = (seams.combing[mesh.face_handle(h).idx()] - field.matching[h.idx()] -
                          seams.combing[mesh.opposite_face_handle(h).idx()]) &
                         3;
    const auto& crossing = seams.crossing[h.idx()];
    if (!crossing) {
      TRIMQUAD_ASSERT(rotation == 0);
      continue;
    }
    if (!crossing->forward) continue;
    TRIMQUAD_ASSERT(!known[crossing->branch] || seams.rotation[crossing->branch] == rotation);
    known[crossing->branch] = 1;
    seams.rotation[crossing->branch] = rotation;
  }
}

}  // namespace

SeamGraph seamGraph(const SurfaceMesh& mesh, const CrossField& field) {
  SeamGraph seams = isPlaneOrTube(mesh, field) ? planeOrTubeSeams(mesh, field)
                                               : branchesOf(mesh, field, cutEdges(mesh, field));
  comb(mesh, field, seams);
  return seams;
}

SeamGraph withoutSeams(const SurfaceMesh& mesh, const CrossField& field, int outerLoop) {
  SeamGraph seams;
  seams.crossing.resize(mesh.n_halfedges());
  seams.outerLoop = outerLoop;
  comb(mesh, field, seams);
  return seams;
}

}  // namespace trimquad
