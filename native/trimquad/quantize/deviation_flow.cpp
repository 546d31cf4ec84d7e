#include "trimquad/quantize/deviation_flow.h"

#include <lemon/network_simplex.h>
#include <lemon/smart_graph.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

using Graph = lemon::SmartDigraph;
using Cost = long long;

/// Costs are rounded to this part of the objective's unit.
constexpr double kCostsPerUnit = double(1 << 24);
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

class DoubleCover {
 public:
  DoubleCover(const Dual& dual, const Objective& objective, const LengthBounds& bounds)
      : dual_(dual), objective_(objective), bounds_(bounds) {}

  /// Both lengths of each arc in the cover, least for costs that are exact in each arc's window.
  std::optional<std::vector<std::array<int, 2>>> solve(const std::vector<Window>& windows) {
    Graph graph;
    for (std::size_t k = 0; k < 2 * dual_.terms.size() + 1; ++k) graph.addNode();
    const Graph::Node border = graph.nodeFromId(int(2 * dual_.terms.size()));
    const auto node = [&](EquationId e, bool second) { return graph.nodeFromId(2 * e.index + second); };
    Graph::ArcMap<int> lower(graph), upper(graph);
    Graph::ArcMap<Cost> cost(graph);
    std::vector<std::array<Bundle, 2>> bundles(dual_.uses.size());
    for (std::size_t a = 0; a < dual_.uses.size(); ++a) {
      const auto& uses = dual_.uses[a];
      for (const bool copy : {false, true}) {
        // A positive sign takes the flow out of the node, in the first copy; the second copy has all
        // reversed.
        const bool out = (uses[0].sign > 0) != copy;
        const Graph::Node first = node(uses[0].equation, copy);
        Graph::Node second = border;
        if (uses.size() == 2) {
          const bool otherCopy = uses[1].sign == uses[0].sign ? !copy : copy;
          second = node(uses[1].equation, otherCopy);
        }
        bundles[a][copy] = addBundle(graph, out ? first : second, out ? second : first, {int(a)}, windows[a],
                                     lower, upper, cost);
      }
    }
    lemon::NetworkSimplex<Graph, int, Cost> simplex(graph);
    simplex.lowerMap(lower).upperMap(upper).costMap(cost);
    const auto status = simplex.run();
    if (status == lemon::NetworkSimplex<Graph, int, Cost>::INFEASIBLE) return {};
    TRIMQUAD_ASSERT(status == (lemon::NetworkSimplex<Graph, int, Cost>::OPTIMAL));
    std::vector<std::array<int, 2>> flow(dual_.uses.size());
    for (std::size_t a = 0; a < dual_.uses.size(); ++a)
      for (int copy = 0; copy < 2; ++copy) {
        flow[a][copy] = 0;
        for (const auto arc : bundles[a][copy].arcs) flow[a][copy] += simplex.flow(arc);
      }
    return flow;
  }

 private:
  Bundle addBundle(Graph& graph, Graph::Node from, Graph::Node to, ArcId a, Window window,
                   Graph::ArcMap<int>& lower, Graph::ArcMap<int>& upper, Graph::ArcMap<Cost>& cost) const {
    const int least = bounds_.least[a.index];
    const int most = bounds_.most[a.index].value_or(std::numeric_limits<int>::max());
    const auto slope = [&](int q) { return objective_.of(a, q + 1) - objective_.of(a, q); };
    const int begin = std::clamp(window.begin, least, most), end = std::clamp(window.end, begin, most);
    // Longer than this is never cheaper.
    const int enough = std::clamp(int(std::ceil(objective_.target[a.index])) + 1, end, most);
    Bundle bundle;
    const auto add = [&](int low, int high, double value) {
      const auto arc = graph.addArc(from, to);
      lower[arc] = low, upper[arc] = high, cost[arc] = std::llround(value * kCostsPerUnit);
      bundle.arcs.push_back(arc);
    };
    add(least, begin, begin > least ? slope(begin - 1) : 0);
    for (int q = begin; q < end; ++q) add(0, 1, slope(q));
    if (end < enough) add(0, enough - end, slope(end));
    if (enough < most) add(0, most - enough, slope(enough));
    return bundle;
  }

  const Dual& dual_;
  const Objective& objective_;
  const LengthBounds& bounds_;
};

}  // namespace

std::optional<DeviationFlow> leastDeviation(const Dual& dual, const Objective& objective,
                                            const LengthBounds& bounds, const ArcLengths& start) {
  DoubleCover cover(dual, objective, bounds);
  std::vector<Window> windows;
  for (const int q : start) windows.push_back(Window::around(q));
  for (int round = 0;; ++round) {
    const auto flow = cover.solve(windows);
    if (!flow) return {};
    bool isExact = true;
    DeviationFlow found{0, {}};
    for (std::size_t a = 0; a < flow->size(); ++a) {
      const auto [x, y] = (*flow)[a];
      found.objective += 0.5 * (objective.of({int(a)}, x) + objective.of({int(a)}, y));
      found.twice.push_back(x + y);
      for (const int q : {x, y}) {
        if (windows[a].holds(q)) continue;
        isExact = false;
        const Window there = Window::around(q);
        if (round < kMoves)
          windows[a] = there;
        else
          windows[a] = {std::min(windows[a].begin, there.begin), std::max(windows[a].end, there.end)};
      }
    }
    if (isExact) return found;
  }
}

LengthBounds boundsOfSeparation(const Dual& dual, const SeparationTest& separation) {
  LengthBounds bounds;
  bounds.most.resize(dual.uses.size());
  for (std::size_t a = 0; a < dual.uses.size(); ++a)
    bounds.least.push_back(separation.mustNotVanish({int(a)}));
  return bounds;
}

namespace {

/// The flow `q` within `bounds`, improved by dropping bounds that turn out not to be needed for separation,
/// one by one.
ArcLengths withoutNeedlessBounds(const Dual& dual, const Objective& objective,
                                 const SeparationTest& separation, LengthBounds bounds, ArcLengths q,
                                 const Progress& progress) {
  double least = objective(q);
  for (std::size_t a = 0; a < q.size(); ++a) {
    if (bounds.least[a] == 0 || q[a] > bounds.least[a] || separation.mustNotVanish({int(a)})) continue;
    progress.check();
    LengthBounds fewer = bounds;
    fewer.least[a] = 0;
    const auto flow = leastDeviation(dual, objective, fewer, q);
    if (!flow || flow->objective > least - 1e-9) continue;
    ArcLengths shorter;
    bool isWhole = true;
    for (const int twice : flow->twice) shorter.push_back(twice / 2), isWhole = isWhole && twice % 2 == 0;
    if (!isWhole || separation.fault(shorter)) continue;
    bounds = std::move(fewer), q = std::move(shorter), least = objective(q);
  }
  return q;
}

}  // namespace

std::optional<ArcLengths> separatedFlow(const Dual& dual, const Objective& objective,
                                        const SeparationTest& separation, const ArcLengths& start,
                                        const Progress& progress) {
  LengthBounds bounds = boundsOfSeparation(dual, separation);
  ArcLengths q = start;
  for (int round = 0; round < kRepairs; ++round) {
    progress.check();
    const auto flow = leastDeviation(dual, objective, bounds, q);
    if (!flow) return {};
    bool isWhole = true;
    for (std::size_t a = 0; a < q.size(); ++a) {
      q[a] = flow->twice[a] / 2;
      if (flow->twice[a] % 2 == 0 || !isWhole) continue;
      // One half length at a time is made whole: upwards, which no separation minds.
      isWhole = false;
      bounds.least[a] = q[a] + 1;
    }
    if (!isWhole) continue;
    const auto faults = separation.faults(q);
    if (faults.empty()) return withoutNeedlessBounds(dual, objective, separation, bounds, q, progress);
    bool canChange = false;
    for (const Collapse& fault : faults) {
      std::optional<ArcId> longest;
      for (const ArcId a : fault.zeroArcs)
        if (bounds.least[a.index] == 0 &&
            (!longest || objective.target[a.index] > objective.target[longest->index]))
          longest = a;
      if (!longest) continue;
      bounds.least[longest->index] = 1;
      canChange = true;
    }
    if (!canChange) return {};
  }
  return {};
}

}  // namespace trimquad
