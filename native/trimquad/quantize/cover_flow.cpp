#include "trimquad/quantize/cover_flow.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

using Cost = DoubleCover::Cost;

/// Costs are rounded to this part of the objective's unit.
constexpr double kCostsPerUnit = double(1 << 24);
constexpr Cost kFar = std::numeric_limits<Cost>::max() / 4;

class Rebalancing {
 public:
  Rebalancing(const DoubleCover& cover, const LengthBounds& bounds, CoverFlow& flow)
      : cover_(cover),
        bounds_(bounds),
        flow_(flow),
        excess_(std::size_t(cover.nodeCount()), 0),
        distance_(excess_.size(), kFar),
        arrival_(excess_.size()),
        settled_(excess_.size(), false) {}

  bool run() {
    for (int a = 0; a < cover_.arcCount(); ++a)
      for (const int copy : {0, 1}) repair({a}, copy);
    for (int node = 0; node < cover_.nodeCount(); ++node)
      while (excess_[std::size_t(node)] > 0)
        if (!sendFrom(node)) return false;
    return true;
  }

 private:
  struct Arrival {
    int from, edge, change;
  };

  int most(ArcId a) const { return bounds_.most[a.index].value_or(std::numeric_limits<int>::max()); }

  /// Of a change of an edge by +1 or -1.
  Cost reducedCost(ArcId a, int copy, int change) const {
    const auto [tail, head] = cover_.edge(a, copy);
    const int q = flow_.flow[a.index][copy];
    const Cost slope = change > 0 ? cover_.slope(a, q) : -cover_.slope(a, q - 1);
    return slope + change * (flow_.potential[tail] - flow_.potential[head]);
  }

  bool canChange(ArcId a, int copy, int change) const {
    const int q = flow_.flow[a.index][copy];
    return change > 0 ? q < most(a) : q > bounds_.least[a.index];
  }

  void change(ArcId a, int copy, int change) {
    const auto [tail, head] = cover_.edge(a, copy);
    flow_.flow[a.index][copy] += change;
    excess_[tail] -= change;
    excess_[head] += change;
  }

  void repair(ArcId a, int copy) {
    const int q = flow_.flow[a.index][copy];
    change(a, copy, std::clamp(q, bounds_.least[a.index], most(a)) - q);
    for (const int step : {1, -1})
      while (canChange(a, copy, step) && reducedCost(a, copy, step) < 0) change(a, copy, step);
  }

  /// One unit from a node that has too much to the nearest that has too little.
  bool sendFrom(int start) {
    std::vector<int> reached{start};
    std::priority_queue<std::pair<Cost, int>, std::vector<std::pair<Cost, int>>, std::greater<>> queue;
    distance_[start] = 0;
    queue.push({0, start});
    std::optional<int> goal;
    while (!queue.empty()) {
      const auto [distance, node] = queue.top();
      queue.pop();
      if (settled_[node]) continue;
      settled_[node] = true;
      if (excess_[node] < 0) {
        goal = node;
        break;
      }
      for (const int e : cover_.incident(node)) {
        const ArcId a{e / 2};
        const auto [tail, head] = cover_.edge(a, e % 2);
        const int change = tail == node ? 1 : -1, to = tail == node ? head : tail;
        if (settled_[to] || !canChange(a, e % 2, change)) continue;
        const Cost next = distance + reducedCost(a, e % 2, change);
        if (next >= distance_[to]) continue;
        if (distance_[to] == kFar) reached.push_back(to);
        distance_[to] = next;
        arrival_[to] = {node, e, change};
        queue.push({next, to});
      }
    }
    if (goal) {
      const Cost far = distance_[*goal];
      for (const int node : reached)
        if (settled_[node]) flow_.potential[node] += distance_[node] - far;
      for (int node = *goal; node != start; node = arrival_[node].from)
        change({arrival_[node].edge / 2}, arrival_[node].edge % 2, arrival_[node].change);
    }
    for (const int node : reached) distance_[node] = kFar, settled_[node] = false;
    return goal.has_value();
  }

  const DoubleCover& cover_;
  const LengthBounds& bounds_;
  CoverFlow& flow_;
  std::vector<int> excess_;  ///< by node: what comes in less what goes out
  std::vector<Cost> distance_;
  std::vector<Arrival> arrival_;
  std::vector<bool> settled_;
};

}  // namespace

DoubleCover::DoubleCover(const Dual& dual, const Objective& objective)
    : objective_(objective), incident_(2 * dual.terms.size() + 1) {
  const int border = int(2 * dual.terms.size());
  for (const auto& uses : dual.uses)
    for (const int copy : {0, 1}) {
      // A positive sign takes the flow out of the node, in the first copy; the second copy has all reversed.
      const bool out = (uses[0].sign > 0) != (copy == 1);
      const int first = 2 * uses[0].equation.index + copy;
      int second = border;
      if (uses.size() == 2)
        second = 2 * uses[1].equation.index + (uses[1].sign == uses[0].sign ? 1 - copy : copy);
      const Edge edge = out ? Edge{first, second} : Edge{second, first};
      if (edge.tail != edge.head)
        for (const int node : {edge.tail, edge.head})
          incident_[std::size_t(node)].push_back(int(edges_.size()));
      edges_.push_back(edge);
    }
}

DoubleCover::Cost DoubleCover::slope(ArcId a, int q) const {
  const double w = objective_.weight[a.index];
  return std::llround(w * (2 * (q - objective_.target[a.index]) + 1) * kCostsPerUnit);
}

double CoverFlow::leastCost(const DoubleCover& cover, ArcId a, int change) const {
  double sum = 0;
  for (const int copy : {0, 1}) {
    const auto [tail, head] = cover.edge(a, copy);
    const int q = flow[a.index][copy];
    const Cost slope = change > 0 ? cover.slope(a, q) : -cover.slope(a, q - 1);
    sum += 0.5 * double(std::max(Cost(0), slope + change * (potential[tail] - potential[head])));
  }
  return sum / kCostsPerUnit;
}

std::optional<CoverFlow> reoptimized(const DoubleCover& cover, const LengthBounds& bounds, CoverFlow flow) {
  if (!Rebalancing(cover, bounds, flow).run()) return {};
  return flow;
}

}  // namespace trimquad
