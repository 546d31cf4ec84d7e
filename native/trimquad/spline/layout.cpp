#include "trimquad/spline/layout.h"

#include <algorithm>
#include <map>

#include "trimquad/base/error.h"
#include "trimquad/spline/chart_blocks.h"

namespace trimquad {
namespace {

/// Outlines of the charts, from the halfedges of the overlay.
class Outlines {
 public:
  Outlines(const CellGraph& graph, const ChartPartition& charts, Layout& result)
      : graph_(graph), overlay_(graph.overlay()), charts_(charts), out_(result) {
    out_.charts.resize(charts.charts.size());
    outlines_.assign(overlay_.points.size(), 0);
    for (int h = 0; h < int(overlay_.halfedges.size()); h += 2)
      if (isOutline(overlay_.halfedges[h].piece >= 0 ? h : h ^ 1)) {
        ++outlines_[overlay_.halfedges[h].origin];
        ++outlines_[overlay_.target(h)];
      }
    placePieces();
    std::vector<char> seen(overlay_.halfedges.size(), 0);
    for (int h = 0; h < int(overlay_.halfedges.size()); ++h)
      if (!seen[h] && overlay_.halfedges[h].piece >= 0 && isOutline(h)) appendLoop(h, seen);
  }

 private:
  bool isOutline(int h) const {
    const auto& edge = overlay_.edges[h >> 1];
    return edge.border || (edge.grid && !charts_.joined(graph_, h));
  }
  Transition toChart(int piece) const {
    return charts_.toChart[graph_.cellOfPiece(piece)].after(graph_.toCell(piece));
  }
  FixedVector at(int h) const { return toChart(overlay_.halfedges[h].piece)(overlay_.halfedges[h].at); }
  FixedVector atEnd(int h) const {
    return toChart(overlay_.halfedges[h].piece)(overlay_.halfedges[overlay_.halfedges[h].next].at);
  }
  int chartAt(int h) const { return charts_.chartOf[graph_.cellAt(h)]; }
  bool isBoundary(int h) const { return overlay_.edges[h >> 1].border; }

  void placePieces() {
    out_.pieces.resize(graph_.map().mesh.n_faces());
    for (int c = 0; c < int(charts_.charts.size()); ++c) {
      auto& chart = out_.charts[c];
      chart.cells = int(charts_.charts[c].size());
      chart.low = chart.boundaryLow = Eigen::Vector2d::Constant(HUGE_VAL);
      chart.high = chart.boundaryHigh = -chart.low;
    }
    for (int p = 0; p < int(overlay_.pieces.size()); ++p)
      out_.pieces[overlay_.pieces[p].triangle.idx()].push_back(
          {overlay_.pieces[p].cell, charts_.chartOf[graph_.cellOfPiece(p)], toChart(p)});
    for (int h = 0; h < int(overlay_.halfedges.size()); ++h) {
      if (overlay_.halfedges[h].piece < 0) continue;
      auto& chart = out_.charts[chartAt(h)];
      for (const FixedVector x : {at(h), atEnd(h)}) {
        const Eigen::Vector2d quads = out_.scale.toQuads(x);
        chart.low = chart.low.cwiseMin(quads);
        chart.high = chart.high.cwiseMax(quads);
        if (!isBoundary(h)) continue;
        chart.boundaryLow = chart.boundaryLow.cwiseMin(quads);
        chart.boundaryHigh = chart.boundaryHigh.cwiseMax(quads);
      }
    }
  }

  /// Whether a stretch ends between two halfedges that follow each other in an outline.
  bool isBreak(int before, int after) const {
    const int p = overlay_.halfedges[after].origin;
    if (outlines_[p] != 2 ||
        (overlay_.points[p].integer && !overlay_.points[p].border && graph_.quarters(p) != 4))
      return true;
    if (isBoundary(before) != isBoundary(after)) return true;
    if (isBoundary(before)) return false;
    if (chartAt(before ^ 1) != chartAt(after ^ 1) || graph_.isFeature(before) != graph_.isFeature(after))
      return true;
    return cross(atEnd(before) - at(before), atEnd(after) - at(after)) != 0;
  }

  int nextInOutline(int h) const {
    h = overlay_.halfedges[h].next;
    while (!isOutline(h)) h = overlay_.halfedges[h ^ 1].next;
    return h;
  }

  void appendLoop(int start, std::vector<char>& seen) {
    std::vector<int> loop;
    for (int h = start; !seen[h]; h = nextInOutline(h)) {
      seen[h] = 1;
      loop.push_back(h);
    }
    const int n = int(loop.size());
    int first = 0;
    while (first < n && !isBreak(loop[(first + n - 1) % n], loop[first])) ++first;
    auto& stretches = out_.charts[chartAt(start)].loops.emplace_back();
    if (first == n) {
      TRIMQUAD_ASSERT(isBoundary(start));
      stretches.push_back(boundaryStretch(loop, true));
      return;
    }
    std::rotate(loop.begin(), loop.begin() + first, loop.end());
    for (int i = 0; i < n;) {
      std::vector<int> part{loop[i++]};
      while (i < n && !isBreak(part.back(), loop[i])) part.push_back(loop[i++]);
      stretches.push_back(isBoundary(part[0]) ? boundaryStretch(part, false) : borderStretch(part));
    }
  }

  int pointId(int overlayPoint) {
    const auto [it, isNew] = pointId_.try_emplace(overlayPoint, int(out_.points.size()));
    if (isNew) {
      const auto& p = overlay_.points[overlayPoint];
      auto& point = out_.points.emplace_back();
      point.position = p.position;
      point.quarters = p.border || p.integer ? graph_.quarters(overlayPoint) : 4;
      point.vertex = p.vertex;
    }
    return it->second;
  }

  Layout::Stretch borderStretch(const std::vector<int>& part) {
    const auto known = borderOf_.find(part[0] >> 1);
    if (known != borderOf_.end()) {
      TRIMQUAD_ASSERT(out_.borders[known->second].chart[1] == chartAt(part[0]));
      return {known->second, false, {}, false};
    }
    const int id = int(out_.borders.size());
    for (const int h : part) borderOf_[h >> 1] = id;
    const int h = part.front(), last = part.back();
    Layout::Border border;
    border.chart[0] = chartAt(h);
    border.chart[1] = chartAt(h ^ 1);
    TRIMQUAD_ASSERT(border.chart[0] != border.chart[1]);
    border.across = charts_.toChart[graph_.cellAcross(h)]
                        .after(graph_.fromAcross(h).inverse())
                        .after(charts_.toChart[graph_.cellAt(h)].inverse());
    border.feature = graph_.isFeature(h);
    border.startPoint = pointId(overlay_.halfedges[h].origin);
    border.endPoint = pointId(overlay_.target(last));
    const FixedVector start = at(h), end = atEnd(last);
    border.start[0] = out_.scale.toQuads(start);
    border.end[0] = out_.scale.toQuads(end);
    border.start[1] = out_.scale.toQuads(border.across(start));
    border.end[1] = out_.scale.toQuads(border.across(end));
    out_.borders.push_back(border);
    return {id, true, {}, false};
  }

  Layout::Stretch boundaryStretch(const std::vector<int>& part, bool closed) {
    const auto& mesh = graph_.map().mesh;
    Layout::Stretch stretch;
    stretch.closed = closed;
    const auto append = [&](int overlayPoint, FixedVector x, HalfedgeHandle h, bool isEnd) {
      const auto& p = overlay_.points[overlayPoint];
      if (!p.vertex.is_valid() && !isEnd) return;
      Layout::BoundaryPoint point{p.vertex, {}, out_.scale.toQuads(x), h, 0};
      if (!p.vertex.is_valid()) {
        const Eigen::Vector3d a = mesh.point(mesh.from_vertex_handle(h)),
                              b = mesh.point(mesh.to_vertex_handle(h));
        point.part = std::clamp((p.position - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
      }
      if (isEnd && !closed) {
        point.point = pointId(overlayPoint);
        auto& meeting = out_.points[*point.point];
        if (!p.vertex.is_valid()) {
          meeting.halfedge = h;
          meeting.part = point.part;
        }
      }
      stretch.boundary.push_back(point);
    };
    for (std::size_t i = 0; i < part.size(); ++i)
      append(overlay_.halfedges[part[i]].origin, at(part[i]), overlay_.halfedges[part[i]].meshHalfedge,
             i == 0 && !closed);
    append(overlay_.target(part.back()), atEnd(part.back()), overlay_.halfedges[part.back()].meshHalfedge,
           !closed);
    return stretch;
  }

  const CellGraph& graph_;
  const GridOverlay& overlay_;
  const ChartPartition& charts_;
  Layout& out_;
  std::vector<int> outlines_;  ///< by point of the overlay: edges of outlines that end there
  std::map<int, int> pointId_, borderOf_;
};

}  // namespace

Eigen::Vector2d Layout::apply(const Transition& t, const FixedScale& scale, const Eigen::Vector2d& x) {
  const Eigen::Vector2d by = scale.toQuads(t.translation);
  switch (t.rotation & 3) {
    case 1:
      return Eigen::Vector2d(-x[1], x[0]) + by;
    case 2:
      return by - x;
    case 3:
      return Eigen::Vector2d(x[1], -x[0]) + by;
    default:
      return x + by;
  }
}

const Layout::Piece& Layout::pieceAt(FaceHandle f, const Eigen::Vector2d& x) const {
  const auto& here = pieces[f.idx()];
  TRIMQUAD_ASSERT(!here.empty());
  const Piece* best = &here.front();
  double bestDistance = HUGE_VAL;
  for (const auto& piece : here) {
    const Eigen::Vector2d low(double(piece.cell.u), double(piece.cell.v));
    const double distance =
        (x - x.cwiseMax(low).cwiseMin(low + Eigen::Vector2d::Ones())).lpNorm<Eigen::Infinity>();
    if (distance < bestDistance) {
      best = &piece;
      bestDistance = distance;
    }
  }
  return *best;
}

Layout layout(const GridMap& map, const std::vector<std::vector<int>>& bisections, const Progress& progress) {
  const CellGraph graph(map, progress);
  auto charts = joined(graph, blocks(graph, progress), progress);
  for (const auto& chosen : bisections) charts = bisected(graph, charts, chosen);
  Layout result;
  result.scale = map.scale;
  Outlines(graph, charts, result);
  return result;
}

}  // namespace trimquad
