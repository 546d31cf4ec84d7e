#include "trimquad/quantize/greedy.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "trimquad/base/error.h"
#include "trimquad/quantize/circuits.h"

namespace trimquad {
namespace {

constexpr double kForbidden = std::numeric_limits<double>::infinity();

/// QGP's cost of a change: small where the arc is too long or too short by more than one and the change
/// helps, large by the number of arcs where it hardly helps, and by its square where it does harm.
double circuitCost(const Objective& objective, ArcId a, int q, int change) {
  const double n = double(objective.target.size());
  const double gain = change * (objective.target[a.index] - q);
  const double w = objective.weight[a.index];
  if (gain >= 1) return w / (gain + 1);
  if (gain >= 0) return w * n / (gain + 1);
  return w * n * n * (1 - gain);
}

/// How often the circuit should be applied: least objective, with no length under `least`; 0 if never.
int bestRepeats(const Objective& objective, const Circuit& circuit, const ArcLengths& q, int least) {
  double gain = 0, curvature = 0;
  int most = std::numeric_limits<int>::max();
  for (const auto& [arc, change] : circuit.steps) {
    gain += objective.weight[arc.index] * change * (objective.target[arc.index] - q[arc.index]);
    curvature += objective.weight[arc.index] * change * change;
    if (change < 0) most = std::min(most, (q[arc.index] - least) / -change);
  }
  const double best = std::floor(gain / curvature + 0.5);
  return best < 1 ? 0 : int(std::min(best, double(most)));
}

double changeOfObjective(const Objective& objective, const Circuit& circuit, const ArcLengths& q,
                         int repeats) {
  double sum = 0;
  for (const auto& [arc, change] : circuit.steps)
    sum += objective.of(arc, q[arc.index] + repeats * change) - objective.of(arc, q[arc.index]);
  return sum;
}

void apply(const Circuit& circuit, int repeats, ArcLengths& q) {
  for (const auto& [arc, change] : circuit.steps) q[arc.index] += repeats * change;
}

/// Arcs by how far they are from their targets, in terms of the objective.
std::vector<ArcId> byDeviation(const Objective& objective, const ArcLengths& q) {
  std::vector<ArcId> order;
  for (std::size_t a = 0; a < q.size(); ++a) order.push_back({int(a)});
  std::stable_sort(order.begin(), order.end(), [&](ArcId a, ArcId b) {
    return objective.of(a, q[a.index]) > objective.of(b, q[b.index]);
  });
  return order;
}

class Improvement {
 public:
  Improvement(const Dual& dual, const Objective& objective, const SeparationTest& separation, ArcLengths& q)
      : objective_(objective), separation_(separation), q_(q), search_(dual) {}

  /// Tries the cheapest circuit through an arc; whether it was taken.
  bool tryThrough(ArcId arc, int change) {
    const auto circuit = search_.through(arc, change, [&](ArcId a, int c, int already) {
      const int q = q_[a.index] + already;
      return q + c < 0 ? kForbidden : circuitCost(objective_, a, q, c);
    });
    if (!circuit) return false;
    std::vector<ArcId> touched;
    for (const auto& step : circuit->steps) touched.push_back(step.arc);
    for (int repeats = bestRepeats(objective_, *circuit, q_, 0); repeats > 0; repeats /= 2) {
      if (changeOfObjective(objective_, *circuit, q_, repeats) > -kLeastGain) continue;
      apply(*circuit, repeats, q_);
      if (!separation_.fault(q_, touched)) return true;
      apply(*circuit, -repeats, q_);
    }
    return false;
  }

 private:
  /// Beyond the rounding of sums, so that changes cannot go round in circles.
  static constexpr double kLeastGain = 1e-9;

  const Objective& objective_;
  const SeparationTest& separation_;
  ArcLengths& q_;
  CircuitSearch search_;
};

}  // namespace

ArcLengths positiveLengths(const Dual& dual, const Objective& objective, const Progress& progress) {
  ArcLengths q(dual.uses.size(), 0);
  CircuitSearch search(dual);
  for (const ArcId a : byDeviation(objective, q)) {
    progress.check();
    if (q[a.index] > 0) continue;
    const auto circuit = search.through(a, 1, [&](ArcId b, int c, int already) {
      return c < 0 ? kForbidden : circuitCost(objective, b, q[b.index] + already, c);
    });
    if (!circuit)
      throw stageError("quantize",
                       "the partition admits no positive lengths; please report this with the input",
                       "arc " + std::to_string(a.index), (*dual.tmesh)[(*dual.tmesh)[a].from].position);
    apply(*circuit, std::max(1, bestRepeats(objective, *circuit, q, 0)), q);
  }
  return q;
}

int improveGreedily(const Dual& dual, const Objective& objective, const SeparationTest& separation,
                    ArcLengths& q, const Progress& progress) {
  Improvement improvement(dual, objective, separation, q);
  int steps = 0;
  for (bool improved = true; improved;) {
    improved = false;
    for (const ArcId a : byDeviation(objective, q)) {
      progress.check();
      const int towards = objective.target[a.index] > q[a.index] ? 1 : -1;
      for (const int change : {towards, -towards})
        while (improvement.tryThrough(a, change)) improved = true, ++steps;
    }
  }
  return steps;
}

}  // namespace trimquad
