#include "trimquad/quantize/deviation_flow.h"

#include <lemon/network_simplex.h>
#include <lemon/smart_graph.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

using Graph = lemon::SmartDigraph;
using Cost = DoubleCover::Cost;

/// Windows reach so far to both sides.
constexpr int kWindow = 3;
/// Collapses are repaired in so many rounds at most.
constexpr int kRepairs = 100;
/// Windows are moved so often, then only made wider.
constexpr int kMoves = 20;

/// The lengths that have their exact costs; beyond, the cost goes on straight, which is never more than it
/// should be.
struct Window {
  int begin, end;

  static Window around(int centre) { return {centre - kWindow, centre + kWindow}; }
  bool holds(int q) const { return begin <= q && q <= end; }
};

/// Parallel arcs whose costs add up to the convex cost of a length.
struct Bundle {
  std::vector<Graph::Arc> arcs;
};

/// A least-cost flow for costs that are exact in each arc's window.
class WindowFlow {
 public:
  WindowFlow(const DoubleCover& cover, const LengthBounds& bounds) : cover_(cover), bounds_(bounds) {}

  std::optional<CoverFlow> solve(const std::vector<Window>& windows) const {
    Graph graph;
    for (int k = 0; k < cover_.nodeCount(); ++k) graph.addNode();
    Graph::ArcMap<int> lower(graph), upper(graph);
    Graph::ArcMap<Cost> cost(graph);
    std::vector<std::array<Bundle, 2>> bundles(windows.size());
    for (std::size_t a = 0; a < windows.size(); ++a)
      for (const int copy : {0, 1}) {
        const auto [tail, head] = cover_.edge({int(a)}, copy);
        bundles[a][copy] = addBundle(graph, graph.nodeFromId(tail), graph.nodeFromId(head), {int(a)},
                                     windows[a], lower, upper, cost);
      }
    lemon::NetworkSimplex<Graph, int, Cost> simplex(graph);
    simplex.lowerMap(lower).upperMap(upper).costMap(cost);
    const auto status = simplex.run();
    if (status == lemon::NetworkSimplex<Graph, int, Cost>::INFEASIBLE) return {};
    TRIMQUAD_ASSERT(status == (lemon::NetworkSimplex<Graph, int, Cost>::OPTIMAL));
    CoverFlow found;
    found.flow.resize(windows.size());
    for (std::size_t a = 0; a < windows.size(); ++a)
      for (const int copy : {0, 1}) {
        found.flow[a][copy] = 0;
        for (const auto arc : bundles[a][copy].arcs) found.flow[a][copy] += simplex.flow(arc);
      }
    for (int k = 0; k < cover_.nodeCount(); ++k)
      found.potential.push_back(simplex.potential(graph.nodeFromId(k)));
    return found;
  }

 private:
  Bundle addBundle(Graph& graph, Graph::Node from, Graph::Node to, ArcId a, Window window,
                   Graph::ArcMap<int>& lower, Graph::ArcMap<int>& upper, Graph::ArcMap<Cost>& cost) const {
    const int least = bounds_.least[a.index];
    const int most = bounds_.most[a.index].value_or(std::numeric_limits<int>::max());
    const int begin = std::clamp(window.begin, least, most), end = std::clamp(window.end, begin, most);
    // Longer than this is never cheaper.
    const int enough = std::clamp(int(std::ceil(cover_.objective().target[a.index])) + 1, end, most);
    Bundle bundle;
    const auto add = [&](int low, int high, Cost value) {
      const auto arc = graph.addArc(from, to);
      lower[arc] = low, upper[arc] = high, cost[arc] = value;
      bundle.arcs.push_back(arc);
    };
    add(least, begin, begin > least ? cover_.slope(a, begin - 1) : 0);
    for (int q = begin; q < end; ++q) add(0, 1, cover_.slope(a, q));
    if (end < enough) add(0, enough - end, cover_.slope(a, end));
    if (enough < most) add(0, most - enough, cover_.slope(a, enough));
    return bundle;
  }

  const DoubleCover& cover_;
  const LengthBounds& bounds_;
};

DeviationFlow deviationOf(const DoubleCover& cover, CoverFlow flow) {
  DeviationFlow found{0, {}, {}};
  for (std::size_t a = 0; a < flow.flow.size(); ++a) {
    const auto [x, y] = flow.flow[a];
    found.objective += 0.5 * (cover.objective().of({int(a)}, x) + cover.objective().of({int(a)}, y));
    found.twice.push_back(x + y);
  }
  found.cover = std::move(flow);
  return found;
}

}  // namespace

std::optional<DeviationFlow> leastDeviation(const DoubleCover& cover, const LengthBounds& bounds,
                                            const ArcLengths& start) {
  const WindowFlow window(cover, bounds);
  std::vector<Window> windows;
  for (const int q : start) windows.push_back(Window::around(q));
  for (int round = 0;; ++round) {
    auto flow = window.solve(windows);
    if (!flow) return {};
    bool isExact = true;
    for (std::size_t a = 0; a < windows.size(); ++a)
      for (const int q : flow->flow[a]) {
        if (windows[a].holds(q)) continue;
        isExact = false;
        const Window there = Window::around(q);
        if (round < kMoves)
          windows[a] = there;
        else
          windows[a] = {std::min(windows[a].begin, there.begin), std::max(windows[a].end, there.end)};
      }
    if (isExact) return deviationOf(cover, std::move(*flow));
  }
}

std::optional<DeviationFlow> leastDeviation(const DoubleCover& cover, const LengthBounds& bounds,
                                            const DeviationFlow& near) {
  auto flow = reoptimized(cover, bounds, near.cover);
  if (!flow) return {};
  return deviationOf(cover, std::move(*flow));
}

LengthBounds boundsOfSeparation(const Dual& dual, const SeparationTest& separation) {
  LengthBounds bounds;
  bounds.most.resize(dual.uses.size());
  for (std::size_t a = 0; a < dual.uses.size(); ++a)
    bounds.least.push_back(separation.mustNotVanish({int(a)}));
  return bounds;
}

namespace {

/// The whole lengths of a flow, if they are.
std::optional<ArcLengths> wholeLengths(const DeviationFlow& flow) {
  ArcLengths q;
  for (const int twice : flow.twice) {
    if (twice % 2 != 0) return {};
    q.push_back(twice / 2);
  }
  return q;
}

/// The flow within `bounds`, improved by dropping bounds that turn out not to be needed for separation, one
/// by one.
ArcLengths withoutNeedlessBounds(const DoubleCover& cover, const SeparationTest& separation,
                                 LengthBounds bounds, DeviationFlow flow, const Progress& progress) {
  ArcLengths q = *wholeLengths(flow);
  for (std::size_t a = 0; a < q.size(); ++a) {
    if (bounds.least[a] == 0 || q[a] > bounds.least[a] || separation.mustNotVanish({int(a)})) continue;
    progress.check();
    const int least = std::exchange(bounds.least[a], 0);
    auto shorter = leastDeviation(cover, bounds, flow);
    TRIMQUAD_ASSERT(shorter);
    const auto whole = wholeLengths(*shorter);
    if (shorter->objective > flow.objective - 1e-9 || !whole || separation.fault(*whole)) {
      bounds.least[a] = least;
      continue;
    }
    flow = std::move(*shorter), q = *whole;
  }
  return q;
}

}  // namespace

std::optional<ArcLengths> separatedFlow(const Dual& dual, const DoubleCover& cover,
                                        const SeparationTest& separation, const DeviationFlow& start,
                                        const Progress& progress) {
  LengthBounds bounds = boundsOfSeparation(dual, separation);
  DeviationFlow flow = start;
  for (int round = 0; round < kRepairs; ++round) {
    progress.check();
    const auto half =
        std::find_if(flow.twice.begin(), flow.twice.end(), [](int twice) { return twice % 2 != 0; });
    if (half != flow.twice.end()) {
      // One half length at a time is made whole: upwards, which no separation minds.
      bounds.least[std::size_t(half - flow.twice.begin())] = *half / 2 + 1;
    } else {
      const auto faults = separation.faults(*wholeLengths(flow));
      if (faults.empty()) return withoutNeedlessBounds(cover, separation, bounds, std::move(flow), progress);
      bool canChange = false;
      for (const Collapse& fault : faults) {
        std::optional<ArcId> longest;
        for (const ArcId a : fault.zeroArcs)
          if (bounds.least[a.index] == 0 &&
              (!longest || cover.objective().target[a.index] > cover.objective().target[longest->index]))
            longest = a;
        if (!longest) continue;
        bounds.least[longest->index] = 1;
        canChange = true;
      }
      if (!canChange) return {};
    }
    auto next = leastDeviation(cover, bounds, flow);
    if (!next) return {};
    flow = std::move(*next);
  }
  return {};
}

}  // namespace trimquad
