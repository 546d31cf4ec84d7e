#include "trimquad/spline/chart_blocks.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <set>

#include "trimquad/base/error.h"
#include "trimquad/spline/hole_lines.h"

namespace trimquad {
namespace {

/// Part of its bounding box that a chart of several blocks fills at least: what lies beyond costs poles.
constexpr double kSmallestFill = 0.9;

class Cuts {
 public:
  explicit Cuts(const CellGraph& graph)
      : graph_(graph), cut_(graph.overlay().edges.size(), 0), touched_(graph.overlay().points.size(), 0) {
    const auto& overlay = graph.overlay();
    for (int p = 0; p < int(touched_.size()); ++p) touched_[p] = isSingular(p);
    for (int h = 0; h < int(overlay.halfedges.size()); ++h)
      if (overlay.edges[h >> 1].grid && !overlay.edges[h >> 1].border && graph.isFeature(h)) {
        cut_[h >> 1] = 1;
        touched_[overlay.halfedges[h].origin] = 1;
      }
  }

  bool operator[](int halfedge) const { return cut_[halfedge >> 1]; }

  void addSeparatrices(const Progress& progress) {
    const auto& overlay = graph_.overlay();
    std::vector<int> traces = linesFromHoles(graph_);
    for (int h = 0; h < int(overlay.halfedges.size()); ++h) {
      const auto& edge = overlay.edges[h >> 1];
      if (edge.grid && !edge.border && isSingular(overlay.halfedges[h].origin)) traces.push_back(h);
    }
    while (!traces.empty()) {
      progress.check();
      std::vector<int> growing;
      for (const int h : traces)
        if (const auto next = advance(h)) growing.push_back(*next);
      traces = std::move(growing);
    }
  }

  /// The whole grid line through the side, up to other cuts.
  void addLine(int halfedge) {
    for (const int h : {halfedge, halfedge ^ 1})
      for (std::optional<int> next = h; next;) next = advance(*next);
  }

 private:
  bool isSingular(int point) const {
    const int quarters = graph_.quarters(point);
    return quarters != 0 && quarters != 4;
  }

  /// Cuts along the grid line from a point of it to the next grid point; gives the halfedge that goes on
  /// straight, unless the cut ends there.
  std::optional<int> advance(int h) {
    const auto& overlay = graph_.overlay();
    for (;; h = graph_.nextClockwise(h ^ 1)) {
      cut_[h >> 1] = 1;
      const int p = overlay.target(h);
      if (overlay.points[p].border) return {};
      if (!overlay.points[p].integer) continue;
      if (touched_[p]) return {};
      touched_[p] = 1;
      return graph_.nextClockwise(graph_.nextClockwise(h ^ 1));
    }
  }

  const CellGraph& graph_;
  std::vector<char> cut_;      ///< by edge of the overlay
  std::vector<char> touched_;  ///< by point of the overlay
};

/// The cells that hang together with `first` over sides that may be passed, by breadth-first search, in its
/// plane.
template <class MayPass>
std::vector<PlacedCell> connected(const CellGraph& graph, const PlacedCell& first, const MayPass& mayPass,
                                  std::vector<char>& reached) {
  std::vector<PlacedCell> cells{first};
  reached[first.cell] = 1;
  for (std::size_t next = 0; next < cells.size(); ++next) {
    const PlacedCell placed = cells[next];
    for (const int h : graph.sides(placed.cell)) {
      const int other = graph.cellAcross(h);
      if (!mayPass(h) || reached[other]) continue;
      reached[other] = 1;
      cells.push_back({other, placed.toChart.after(graph.fromAcross(h))});
    }
  }
  return cells;
}

/// The side in the middle of the shortest way from one cell to the other that crosses no cut.
std::optional<int> middleOfWay(const CellGraph& graph, const Cuts& cuts, int from, int to) {
  std::map<int, int> entered{{from, -1}};  // by cell: the side by which it was left, of the cell before
  std::deque<int> queue{from};
  while (!queue.empty() && !entered.count(to)) {
    const int cell = queue.front();
    queue.pop_front();
    for (const int h : graph.sides(cell))
      if (!cuts[h] && entered.try_emplace(graph.cellAcross(h), h).second)
        queue.push_back(graph.cellAcross(h));
  }
  std::vector<int> way;
  for (int cell = to; cell != from;) {
    const int h = entered.at(cell);
    way.push_back(h);
    cell = graph.cellAt(h);
  }
  if (way.empty()) return {};
  return way[way.size() / 2];
}

struct Link {
  Transition fromOther;  ///< from the plane of the neighbour
  bool good = true;      ///< all common sides agree on it, none is a feature
  int sides = 0;
};

struct Box {
  FixedVector low, high;  ///< on the doubled grid, of the cells' centres
  void extend(FixedVector x) {
    low = {std::min(low.u, x.u), std::min(low.v, x.v)};
    high = {std::max(high.u, x.u), std::max(high.v, x.v)};
  }
  double area() const { return (double(high.u - low.u) / 2 + 1) * (double(high.v - low.v) / 2 + 1); }
};

class Joining {
 public:
  Joining(const CellGraph& graph, const ChartPartition& charts)
      : graph_(graph), result_(charts), version_(charts.charts.size(), 0) {
    for (int c = 0; c < int(charts.charts.size()); ++c) {
      links_.push_back(linksOf(c));
      boxes_.push_back(boxOf(c));
    }
  }

  ChartPartition run(const Progress& progress) {
    for (;;) {
      progress.check();
      const auto best = bestPair();
      if (!best) break;
      const auto [a, b] = *best;
      auto cells = result_.charts[a];
      const Transition t = links_[a].at(b).fromOther;
      for (const auto& placed : result_.charts[b]) cells.push_back({placed.cell, t.after(placed.toChart)});
      if (conflict(graph_, cells))
        refused_.insert({a, version_[a], b, version_[b]});
      else
        join(a, b, std::move(cells));
    }
    ChartPartition compact;
    compact.chartOf = result_.chartOf;
    compact.toChart = result_.toChart;
    for (auto& cells : result_.charts) {
      if (cells.empty()) continue;
      for (const auto& placed : cells) compact.chartOf[placed.cell] = int(compact.charts.size());
      compact.charts.push_back(std::move(cells));
    }
    return compact;
  }

 private:
  std::map<int, Link> linksOf(int chart) const {
    std::map<int, Link> links;
    for (const auto& placed : result_.charts[chart])
      for (const int h : graph_.sides(placed.cell)) {
        const int other = graph_.cellAcross(h), neighbour = result_.chartOf[other];
        if (neighbour == chart) continue;
        const Transition t =
            placed.toChart.after(graph_.fromAcross(h)).after(result_.toChart[other].inverse());
        auto [it, isNew] = links.try_emplace(neighbour);
        Link& link = it->second;
        if (isNew) link.fromOther = t;
        link.good = link.good && !graph_.isFeature(h) && !leavesSingularity(h) && link.fromOther == t;
        ++link.sides;
      }
    return links;
  }

  /// Around a singularity every quarter turn needs a corner of a chart: a chart that went on straight there
  /// could have no tangent plane.
  bool leavesSingularity(int h) const {
    for (const int p : {graph_.overlay().halfedges[h].origin, graph_.overlay().target(h)})
      if (const int quarters = graph_.quarters(p); quarters != 0 && quarters != 4) return true;
    return false;
  }

  Box boxOf(int chart) const {
    const auto placeOf = [&](const PlacedCell& placed) {
      return graph_.moved(placed.toChart, graph_.place(placed.cell));
    };
    const FixedVector first = placeOf(result_.charts[chart].front());
    Box box{first, first};
    for (const auto& placed : result_.charts[chart]) box.extend(placeOf(placed));
    return box;
  }

  std::optional<std::pair<int, int>> bestPair() const {
    std::optional<std::pair<int, int>> best;
    std::pair<double, int> bestGain;
    for (int a = 0; a < int(links_.size()); ++a)
      for (const auto& [b, link] : links_[a]) {
        if (b < a || !link.good || refused_.count({a, version_[a], b, version_[b]})) continue;
        Box box = boxes_[a];
        box.extend(graph_.moved(link.fromOther, boxes_[b].low));
        box.extend(graph_.moved(link.fromOther, boxes_[b].high));
        const double fill = double(result_.charts[a].size() + result_.charts[b].size()) / box.area();
        const std::pair<double, int> gain{std::min(fill, 1.0), link.sides};
        if (fill < kSmallestFill || (best && gain <= bestGain)) continue;
        best = {a, b};
        bestGain = gain;
      }
    return best;
  }

  void join(int a, int b, std::vector<PlacedCell> cells) {
    for (const auto& placed : cells) {
      result_.chartOf[placed.cell] = a;
      result_.toChart[placed.cell] = placed.toChart;
    }
    result_.charts[a] = std::move(cells);
    result_.charts[b].clear();
    ++version_[a];
    for (const int gone : {a, b})
      for (const auto& [neighbour, link] : links_[gone]) {
        links_[neighbour].erase(a);
        links_[neighbour].erase(b);
      }
    links_[b].clear();
    links_[a] = linksOf(a);
    for (const auto& [neighbour, link] : links_[a])
      links_[neighbour][a] = {link.fromOther.inverse(), link.good, link.sides};
    boxes_[a] = boxOf(a);
  }

  const CellGraph& graph_;
  ChartPartition result_;
  std::vector<int> version_;
  std::vector<std::map<int, Link>> links_;
  std::vector<Box> boxes_;
  std::set<std::array<int, 4>> refused_;
};

/// Place on the doubled grid of the cell in its chart.
FixedVector placeOf(const CellGraph& graph, const ChartPartition& charts, int cell) {
  return graph.moved(charts.toChart[cell], graph.place(cell));
}

/// By cell: a normal of its surface, averaged over the triangles that reach into it.
std::vector<Eigen::Vector3d> cellNormals(const CellGraph& graph) {
  const auto& mesh = graph.map().mesh;
  std::vector<Eigen::Vector3d> result(graph.size(), Eigen::Vector3d::Zero());
  for (int c = 0; c < graph.size(); ++c)
    for (const int piece : graph.pieces(c)) {
      const auto& here = graph.overlay().pieces[piece];
      result[c] += double(here.doubleArea) * mesh.calc_face_normal(here.triangle);
    }
  for (auto& n : result) n.normalize();
  return result;
}

/// A grid line of a chart's plane.
struct ChartLine {
  int axis;   ///< that it crosses
  Quanta at;  ///< on the doubled grid, even
  bool isBeyond(FixedVector place) const { return place[axis] > at; }
};

/// The line to cut a chart at, if it has more than one row of cells.
std::optional<ChartLine> middleOfBend(const CellGraph& graph, const ChartPartition& charts, int chart,
                                      const std::vector<Eigen::Vector3d>& normals) {
  struct Sum {
    double angle = 0;
    int sides = 0;
  };
  std::map<Quanta, Sum> bend[2];  // by line
  for (const auto& placed : charts.charts[chart])
    for (const int h : graph.sides(placed.cell)) {
      const int other = graph.cellAcross(h);
      if (charts.chartOf[other] != chart) continue;
      const FixedVector here = placeOf(graph, charts, placed.cell), there = placeOf(graph, charts, other);
      const int axis = here.u == there.u ? 1 : 0;
      auto& sum = bend[axis][(here[axis] + there[axis]) / 2];
      const Eigen::Vector3d &n = normals[placed.cell], &m = normals[other];
      sum.angle += std::atan2(n.cross(m).norm(), n.dot(m));
      ++sum.sides;
    }
  double total[2] = {0, 0};
  for (const int axis : {0, 1})
    for (const auto& [line, sum] : bend[axis]) total[axis] += sum.angle / sum.sides;
  const int axis = bend[1].empty() || (!bend[0].empty() && total[0] >= total[1]) ? 0 : 1;
  double passed = 0;
  for (const auto& [line, sum] : bend[axis]) {
    passed += sum.angle / sum.sides;
    if (passed >= total[axis] / 2) return ChartLine{axis, line};
  }
  return {};
}

}  // namespace

ChartPartition blocks(const CellGraph& graph, const Progress& progress) {
  Cuts cuts(graph);
  cuts.addSeparatrices(progress);
  ChartPartition result;
  for (bool valid = false; !valid;) {
    progress.check();
    valid = true;
    result.charts.clear();
    result.chartOf.assign(graph.size(), 0);
    result.toChart.assign(graph.size(), {});
    std::vector<char> reached(graph.size(), 0);
    std::vector<std::pair<int, int>> apart;
    for (int first = 0; first < graph.size(); ++first) {
      if (reached[first]) continue;
      auto cells = connected(
          graph, {first, {}}, [&](int h) { return !cuts[h]; }, reached);
      if (const auto pair = conflict(graph, cells)) apart.push_back(*pair);
      for (const auto& placed : cells) {
        result.chartOf[placed.cell] = int(result.charts.size());
        result.toChart[placed.cell] = placed.toChart;
      }
      result.charts.push_back(std::move(cells));
    }
    for (const auto& [a, b] : apart) {
      const auto side = middleOfWay(graph, cuts, a, b);
      if (!side) {
        const auto& piece = graph.overlay().pieces[graph.pieces(a).front()];
        const auto& mesh = graph.map().mesh;
        throw coarseError("fit", "a quad borders itself at a singularity; use a smaller edge length",
                          "triangle " + std::to_string(piece.triangle.idx()),
                          mesh.point(mesh.from_vertex_handle(mesh.halfedge_handle(piece.triangle))));
      }
      cuts.addLine(*side);
      valid = false;
    }
  }
  return result;
}

ChartPartition joined(const CellGraph& graph, const ChartPartition& charts, const Progress& progress) {
  return Joining(graph, charts).run(progress);
}

ChartPartition bisected(const CellGraph& graph, const ChartPartition& charts,
                        const std::vector<int>& chosen) {
  const auto normals = cellNormals(graph);
  ChartPartition result = charts;
  std::vector<char> reached(graph.size(), 0);
  for (const int chart : chosen) {
    const auto line = middleOfBend(graph, charts, chart, normals);
    if (!line) continue;
    const auto isBeyond = [&](int cell) { return line->isBeyond(placeOf(graph, charts, cell)); };
    const auto mayPass = [&](int h) {
      const int other = graph.cellAcross(h);
      return charts.chartOf[other] == chart && isBeyond(other) == isBeyond(graph.cellAt(h));
    };
    std::vector<PlacedCell> cells = charts.charts[chart];
    std::sort(cells.begin(), cells.end(),
              [](const PlacedCell& a, const PlacedCell& b) { return a.cell < b.cell; });
    // Each side of the line may consist of several parts; the first keeps the chart's number.
    int id = chart;
    for (const auto& placed : cells) {
      if (reached[placed.cell]) continue;
      auto part = connected(graph, placed, mayPass, reached);
      for (const auto& member : part) result.chartOf[member.cell] = id;
      if (id == chart)
        result.charts[id] = std::move(part);
      else
        result.charts.push_back(std::move(part));
      id = int(result.charts.size());
    }
  }
  return result;
}

}  // namespace trimquad
