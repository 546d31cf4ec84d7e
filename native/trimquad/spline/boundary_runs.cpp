#include "trimquad/spline/boundary_runs.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

/// A run of a region as the mesh has it, in the direction of the loop.
struct MeshRun {
  int loop;
  CurveId curve;
  bool forward;
  std::vector<HalfedgeHandle> halfedges;  ///< inner ones
  std::vector<VertexHandle> vertices;
  std::vector<double> t;
};

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

std::vector<MeshRun> meshRuns(const Model& model, int regionIndex) {
  const Region& region = model.regions[regionIndex];
  const SurfaceMesh& mesh = region.mesh;
  std::vector<MeshRun> runs;
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

    for (std::size_t i = 0; i < loop.size();) {
      MeshRun run{loopIndex, curveOf(loop[i]), true, {}, {mesh.from_vertex_handle(loop[i])}, {}};
      do {
        const auto h = loop[i];
        if (curveOf(h) != run.curve)
          throw stageError("fit", "the boundary changes its curve between corners", region.name,
                           mesh.point(mesh.from_vertex_handle(h)));
        run.halfedges.push_back(h);
        run.vertices.push_back(mesh.to_vertex_handle(h));
        ++i;
      } while (i < loop.size() && !isCorner(loop[i]));
      const ModelCurve& curve = model.curves[run.curve.index];
      run.forward = runsForward(region, curve, run.vertices);
      for (const auto v : run.vertices) run.t.push_back(region.curveParameter[v.idx()]);
      run.t.front() = run.forward ? curve.curve->first() : curve.curve->last();
      run.t.back() = run.forward ? curve.curve->last() : curve.curve->first();
      runs.push_back(std::move(run));
    }
    ++loopIndex;
  }
  return runs;
}

/// Turns a run that goes against its curve.
void alongCurve(BoundaryRun& run) {
  if (run.forward) return;
  std::reverse(run.points.begin(), run.points.end());
  std::reverse(run.t.begin(), run.t.end());
  std::reverse(run.uv.begin(), run.uv.end());
  std::swap(run.start, run.end);
}

RunEnd runEnd(const Region& region, VertexHandle v) {
  return {region.corner[v.idx()]->index, v.idx()};
}

/// A part of a boundary halfedge between points of a chart's outline.
struct OutlinePart {
  double from, to;  ///< along the halfedge, 0..1
  Eigen::Vector2d fromUv, toUv;
  int chart, loop, stretch, index;
  std::optional<int> endPoint;  ///< of the layout, where the stretch ends with this part
};

std::map<int, std::vector<OutlinePart>> outlineParts(const Layout& layout) {
  std::map<int, std::vector<OutlinePart>> parts;
  for (int c = 0; c < int(layout.charts.size()); ++c)
    for (int l = 0; l < int(layout.charts[c].loops.size()); ++l)
      for (int s = 0; s < int(layout.charts[c].loops[l].size()); ++s) {
        const auto& boundary = layout.charts[c].loops[l][s].boundary;
        for (int i = 0; i + 1 < int(boundary.size()); ++i) {
          const auto &p = boundary[i], &q = boundary[i + 1];
          parts[p.halfedge.idx()].push_back({p.vertex.is_valid() ? 0 : p.part,
                                             q.vertex.is_valid() ? 1 : q.part, p.at, q.at, c, l, s, i,
                                             q.point});
        }
      }
  for (auto& [h, list] : parts)
    std::sort(list.begin(), list.end(),
              [](const OutlinePart& a, const OutlinePart& b) { return a.from < b.from; });
  return parts;
}

}  // namespace

std::vector<BoundaryRun> boundaryRuns(const Model& model, int regionIndex, const Chart& chart) {
  const Region& region = model.regions[regionIndex];
  const SurfaceMesh& mesh = region.mesh;
  std::vector<BoundaryRun> runs;
  FixedVector at;
  int loop = -1;
  for (const auto& run : meshRuns(model, regionIndex)) {
    if (run.loop != loop) {
      loop = run.loop;
      at = chart.corner[run.halfedges.front().idx()];
    }
    auto& result = runs.emplace_back(BoundaryRun{regionIndex,
                                                 0,
                                                 {run.loop, 0, int(runs.size())},
                                                 run.curve,
                                                 run.forward,
                                                 runEnd(region, run.vertices.front()),
                                                 runEnd(region, run.vertices.back()),
                                                 {},
                                                 run.t,
                                                 {chart.scale.toQuads(at)}});
    for (const auto h : run.halfedges) {
      at = at + (chart.corner[mesh.next_halfedge_handle(h).idx()] - chart.corner[h.idx()]);
      result.uv.push_back(chart.scale.toQuads(at));
    }
    for (const auto v : run.vertices) result.points.push_back(mesh.point(v));
    alongCurve(result);
  }
  return runs;
}

std::vector<BoundaryRun> boundaryRuns(const Model& model, int regionIndex, const Layout& layout, int& corners,
                                      std::vector<CurveSplit>& splits) {
  const Region& region = model.regions[regionIndex];
  const SurfaceMesh& mesh = region.mesh;
  const auto parts = outlineParts(layout);
  std::map<int, int> cornerOfPoint;
  std::vector<BoundaryRun> runs;
  for (const auto& run : meshRuns(model, regionIndex)) {
    bool open = false;  // whether the last run goes on
    RunEnd previous = runEnd(region, run.vertices.front());
    for (std::size_t i = 0; i < run.halfedges.size(); ++i) {
      const Eigen::Vector3d a = mesh.point(run.vertices[i]), b = mesh.point(run.vertices[i + 1]);
      const auto& list = parts.at(run.halfedges[i].idx());
      for (std::size_t k = 0; k < list.size(); ++k) {
        const auto& part = list[k];
        const auto tAt = [&](double x) { return (1 - x) * run.t[i] + x * run.t[i + 1]; };
        if (!open) {
          runs.push_back({regionIndex,
                          part.chart,
                          {part.loop, part.stretch, part.index},
                          run.curve,
                          run.forward,
                          previous,
                          previous,
                          {(1 - part.from) * a + part.from * b},
                          {tAt(part.from)},
                          {part.fromUv}});
          open = true;
        }
        auto& now = runs.back();
        now.points.push_back((1 - part.to) * a + part.to * b);
        now.t.push_back(tAt(part.to));
        now.uv.push_back(part.toUv);
        const bool last = i + 1 == run.halfedges.size() && k + 1 == list.size();
        if (!part.endPoint && !last) continue;
        if (last) {
          previous = runEnd(region, run.vertices.back());
        } else {
          const auto [it, isNew] = cornerOfPoint.try_emplace(*part.endPoint, corners);
          if (isNew) splits.push_back({run.curve, now.t.back(), corners++, regionIndex, *part.endPoint});
          previous = {it->second, -1 - it->second, part.endPoint};
        }
        now.end = previous;
        alongCurve(now);
        open = false;
      }
    }
  }
  return runs;
}

void startAt(BoundaryRun& run, double t, const Eigen::Vector3d& point) {
  std::size_t passed = 0;
  while (passed + 2 < run.t.size() && run.t[passed + 1] <= t) ++passed;
  run.t.erase(run.t.begin() + 1, run.t.begin() + 1 + long(passed));
  run.points.erase(run.points.begin() + 1, run.points.begin() + 1 + long(passed));
  run.uv.erase(run.uv.begin() + 1, run.uv.begin() + 1 + long(passed));
  run.t.front() = t;
  run.points.front() = point;
}

void endAt(BoundaryRun& run, double t, const Eigen::Vector3d& point) {
  std::size_t passed = 0;
  while (passed + 2 < run.t.size() && run.t.end()[-2 - long(passed)] >= t) ++passed;
  run.t.erase(run.t.end() - 1 - long(passed), run.t.end() - 1);
  run.points.erase(run.points.end() - 1 - long(passed), run.points.end() - 1);
  run.uv.erase(run.uv.end() - 1 - long(passed), run.uv.end() - 1);
  run.t.back() = t;
  run.points.back() = point;
}

void cutAtSplits(const Model& model, const std::vector<CurveSplit>& splits, std::vector<BoundaryRun>& runs) {
  for (const auto& split : splits) {
    const std::size_t count = runs.size();
    for (std::size_t r = 0; r < count; ++r) {
      BoundaryRun& run = runs[r];
      if (run.curve != split.curve || run.start.corner == split.corner || run.end.corner == split.corner ||
          !(run.t.front() < split.t && split.t < run.t.back()))
        continue;
      const std::size_t i = std::upper_bound(run.t.begin(), run.t.end(), split.t) - run.t.begin();
      const double x = (split.t - run.t[i - 1]) / (run.t[i] - run.t[i - 1]);
      const Eigen::Vector2d uv = (1 - x) * run.uv[i - 1] + x * run.uv[i];
      const Eigen::Vector3d point = model.curves[run.curve.index].curve->point(split.t);
      BoundaryRun rest = run;
      const auto keepFrom = [&](auto& list, const auto& first) {
        list.erase(list.begin(), list.begin() + i);
        list.insert(list.begin(), first);
      };
      const auto keepUpTo = [&](auto& list, const auto& last) {
        list.resize(i);
        list.push_back(last);
      };
      keepFrom(rest.points, point);
      keepFrom(rest.t, split.t);
      keepFrom(rest.uv, uv);
      keepUpTo(run.points, point);
      keepUpTo(run.t, split.t);
      keepUpTo(run.uv, uv);
      rest.start = run.end = {split.corner, -1 - split.corner};
      runs.insert(runs.begin() + (run.forward ? r + 1 : r), rest);
      break;
    }
  }
}

}  // namespace trimquad
