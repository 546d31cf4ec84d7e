#include "trimquad/spline/boundary_runs.h"

#include <algorithm>
#include <cmath>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

/// Whether a run that visits `vertices` in this order goes along its curve.
bool runsForward(const Region& region, const ModelCurve& curve, const std::vector<VertexHandle>& vertices) {
  const auto parameter = [&](std::size_t i) { return region.curveParameter[vertices[i].idx()]; };
  const std::size_t last = vertices.size() - 1;
  if (last >= 3) return parameter(last - 1) > parameter(1);
  if (curve.start != curve.end) return *region.corner[vertices.front().idx()] == curve.start;
  if (last < 2) return true;
  const auto& line = *curve.curve;
  const Eigen::Vector3d middle = (region.mesh.point(vertices[0]) + region.mesh.point(vertices[1])) / 2;
  const Eigen::Vector3d before = line.point((line.first() + parameter(1)) / 2);
  const Eigen::Vector3d after = line.point((parameter(1) + line.last()) / 2);
  return (middle - before).norm() <= (middle - after).norm();
}

}  // namespace

std::vector<BoundaryRun> boundaryRuns(const Model& model, int regionIndex, const Chart& chart) {
  const Region& region = model.regions[regionIndex];
  const SurfaceMesh& mesh = region.mesh;
  std::vector<BoundaryRun> runs;
  int loopIndex = 0;
  for (auto loop : boundaryLoops(mesh)) {
    // With the region on the left: the inner halfedges, backwards.
    std::reverse(loop.begin(), loop.end());
    for (auto& h : loop) h = mesh.opposite_halfedge_handle(h);
    const auto curveOf = [&](HalfedgeHandle h) {
      const auto id = region.edgeCurve[mesh.edge_handle(h).idx()];
      if (!id)
        throw stageError("fit", "a boundary edge lies on no curve of the model", region.name,
                         mesh.point(mesh.from_vertex_handle(h)));
      return *id;
    };
    const auto isCorner = [&](HalfedgeHandle h) {
      return region.corner[mesh.from_vertex_handle(h).idx()].has_value();
    };
    const auto start = std::find_if(loop.begin(), loop.end(), isCorner);
    if (start == loop.end())
      throw stageError("fit", "a boundary loop has no corner", region.name,
                       mesh.point(mesh.from_vertex_handle(loop.front())));
    std::rotate(loop.begin(), start, loop.end());

    FixedVector at = chart.corner[loop.front().idx()];
    for (std::size_t i = 0; i < loop.size();) {
      BoundaryRun run{regionIndex, loopIndex, curveOf(loop[i]), true, {mesh.from_vertex_handle(loop[i])},
                      {},          {}};
      run.uv.push_back(chart.scale.toQuads(at));
      do {
        const auto h = loop[i];
        if (curveOf(h) != run.curve)
          throw stageError("fit", "the boundary changes its curve between corners", region.name,
                           mesh.point(mesh.from_vertex_handle(h)));
        at = at + (chart.corner[mesh.next_halfedge_handle(h).idx()] - chart.corner[h.idx()]);
        run.vertices.push_back(mesh.to_vertex_handle(h));
        run.uv.push_back(chart.scale.toQuads(at));
        ++i;
      } while (i < loop.size() && !isCorner(loop[i]));
      const ModelCurve& curve = model.curves[run.curve.index];
      run.forward = runsForward(region, curve, run.vertices);
      if (!run.forward) {
        std::reverse(run.vertices.begin(), run.vertices.end());
        std::reverse(run.uv.begin(), run.uv.end());
      }
      for (const auto v : run.vertices) run.t.push_back(region.curveParameter[v.idx()]);
      run.t.front() = curve.curve->first();
      run.t.back() = curve.curve->last();
      runs.push_back(std::move(run));
    }
    ++loopIndex;
  }
  return runs;
}

}  // namespace trimquad
