#include "trimquad/field/loop_turning.h"

#include <cmath>
#include <numbers>
#include <queue>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

/// Shortest paths from the vertices of loop 0 to the other loops, as a tree of loops joined one after the
/// other.
std::vector<std::vector<HalfedgeHandle>> joiningPaths(const SurfaceMesh& mesh,
                                                      const std::vector<std::vector<HalfedgeHandle>>& loops) {
  std::vector<int> loopOf(mesh.n_vertices(), -1);
  for (int l = 0; l < int(loops.size()); ++l)
    for (const auto h : loops[l]) loopOf[mesh.from_vertex_handle(h).idx()] = l;
  std::vector<char> joined(loops.size(), 0);
  std::vector<std::vector<HalfedgeHandle>> paths;
  std::vector<double> distance(mesh.n_vertices(), INFINITY);
  std::vector<HalfedgeHandle> arrival(mesh.n_vertices());
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  const auto start = [&](int loop) {
    joined[loop] = 1;
    for (const auto h : loops[loop]) {
      const int v = mesh.from_vertex_handle(h).idx();
      distance[v] = 0;
      arrival[v] = HalfedgeHandle();
      queue.emplace(0.0, v);
    }
  };
  start(0);
  while (!queue.empty() && paths.size() + 1 < loops.size()) {
    const auto [d, v] = queue.top();
    queue.pop();
    if (d > distance[v]) continue;
    if (loopOf[v] >= 0 && !joined[loopOf[v]]) {
      auto& path = paths.emplace_back();
      for (int w = v; arrival[w].is_valid(); w = mesh.from_vertex_handle(arrival[w]).idx())
        path.push_back(arrival[w]);
      start(loopOf[v]);
      continue;
    }
    for (const auto h : mesh.voh_range(VertexHandle(v))) {
      if (mesh.is_boundary(mesh.edge_handle(h))) continue;
      const auto w = mesh.to_vertex_handle(h);
      const double next = d + (mesh.point(w) - mesh.point(VertexHandle(v))).norm();
      if (next >= distance[w.idx()]) continue;
      distance[w.idx()] = next;
      arrival[w.idx()] = h;
      queue.emplace(next, w.idx());
    }
  }
  TRIMQUAD_ASSERT(paths.size() + 1 == loops.size());
  return paths;
}

}  // namespace

double tangentTurn(const SurfaceMesh& mesh, const std::vector<HalfedgeHandle>& loop) {
  double turn = 0;
  for (const auto h : loop) {
    turn += std::numbers::pi;
    for (const auto out : mesh.voh_range(mesh.from_vertex_handle(h)))
      if (!mesh.is_boundary(out)) turn -= cornerAngle(mesh, out);
  }
  return turn;
}

LoopTurning loopTurning(const SurfaceMesh& mesh, const Transport& transport) {
  LoopTurning result;
  result.loops = boundaryLoops(mesh);
  int total = 0;
  for (const auto& loop : result.loops) {
    double turn = tangentTurn(mesh, loop);  // against the frames: exterior angles, then frames
    walkBeside(mesh, loop, [&](HalfedgeHandle h) { turn += transport.angle[h.idx()]; });
    const double turns = turn / (2 * std::numbers::pi);
    TRIMQUAD_ASSERT(std::abs(turns - std::round(turns)) < 0.1);
    result.turns.push_back(int(std::lround(turns)));
    total += result.turns.back();
  }
  TRIMQUAD_ASSERT(total == eulerCharacteristic(mesh));
  result.paths = joiningPaths(mesh, result.loops);
  for (const auto& path : result.paths) {
    std::vector<int> crossing(mesh.n_halfedges(), 0);
    for (const auto h : path) {
      crossing[h.idx()] += 1;
      crossing[mesh.opposite_halfedge_handle(h).idx()] -= 1;
    }
    auto& effect = result.effect.emplace_back();
    for (const auto& loop : result.loops) {
      int sum = 0;
      walkBeside(mesh, loop, [&](HalfedgeHandle h) { sum += crossing[h.idx()]; });
      effect.push_back(sum);
    }
  }
  return result;
}

std::vector<int> generatorTurns(const LoopTurning& turning, const std::vector<int>& wanted) {
  // The paths make a tree of the loops: loops are taken in the reverse order in which they were joined, and
  // each is put right by the path that joined it.
  const int generators = int(turning.paths.size());
  std::vector<int> result(generators, 0), current = turning.turns;
  std::vector<char> used(generators, 0), done(wanted.size(), 0);
  for (int round = 0; round < generators; ++round) {
    for (int l = 0; l < int(wanted.size()); ++l) {
      if (done[l]) continue;
      int count = 0, only = -1;
      for (int g = 0; g < generators; ++g)
        if (!used[g] && turning.effect[g][l] != 0) ++count, only = g;
      if (count != 1) continue;
      TRIMQUAD_ASSERT(std::abs(turning.effect[only][l]) == 1);
      const int amount = (wanted[l] - current[l]) * turning.effect[only][l];
      result[only] = amount;
      for (int m = 0; m < int(wanted.size()); ++m) current[m] += amount * turning.effect[only][m];
      used[only] = done[l] = 1;
      break;
    }
  }
  TRIMQUAD_ASSERT(current == wanted);
  return result;
}

}  // namespace trimquad
