#include "trimquad/quantize/circuits.h"

#include <algorithm>
#include <limits>
#include <queue>

namespace trimquad {

CircuitSearch::CircuitSearch(const Dual& dual)
    : dual_(dual), arrivals_(2 * dual.terms.size()), changed_(dual.uses.size(), 0) {}

std::optional<CircuitSearch::Leg> CircuitSearch::settle(Debt start, std::optional<Debt> goal,
                                                        const ChangeCost& cost,
                                                        const std::vector<int>& already) {
  ++round_;
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> waiting;
  arrivals_[start.index()] = {0, start, {0}, 0, round_, false};
  waiting.push({0, start.index()});
  double borderCost = std::numeric_limits<double>::infinity();
  Debt borderFrom{};
  Circuit::Step borderStep{};
  const auto trace = [&](Debt d, std::vector<Circuit::Step> steps) {
    while (d.index() != start.index()) {
      const Arrival& a = arrivals_[d.index()];
      steps.push_back({a.arc, a.change});
      d = a.from;
    }
    return steps;
  };
  while (!waiting.empty()) {
    const auto [distance, index] = waiting.top();
    waiting.pop();
    if (distance >= borderCost) break;
    const Debt debt{EquationId{index / 2}, index % 2 ? 1 : -1};
    Arrival& here = arrivals_[index];
    if (here.settled) continue;
    here.settled = true;
    if (goal && debt.index() == goal->index()) return Leg{trace(debt, {}), true};
    for (const Dual::Term& term : dual_[debt.equation]) {
      const int change = -debt.sign * term.sign;
      const double step = cost(term.arc, change, already[term.arc.index]);
      if (!(distance + step < borderCost)) continue;
      const auto& uses = dual_.uses[term.arc.index];
      if (uses.size() == 1) {
        borderCost = distance + step;
        borderFrom = debt;
        borderStep = {term.arc, change};
        continue;
      }
      const Dual::Use& other = uses[1 - term.use];
      const Debt next{other.equation, other.sign * change};
      Arrival& there = arrivals_[next.index()];
      if (there.round == round_ && there.cost <= distance + step) continue;
      there = {distance + step, debt, term.arc, change, round_, false};
      waiting.push({distance + step, next.index()});
    }
  }
  if (borderCost == std::numeric_limits<double>::infinity()) return {};
  return Leg{trace(borderFrom, {borderStep}), false};
}

std::optional<Circuit> CircuitSearch::through(ArcId arc, int change, const ChangeCost& cost) {
  if (cost(arc, change, 0) == std::numeric_limits<double>::infinity()) return {};
  std::vector<ArcId> touched;
  const auto apply = [&](ArcId a, int c) {
    changed_[a.index] += c;
    touched.push_back(a);
  };
  const auto& uses = dual_.uses[arc.index];
  const auto search = [&] {
    apply(arc, change);
    std::optional<Debt> second;
    if (uses.size() == 2) second = Debt{uses[1].equation, uses[1].sign * change};
    // Balance at the other end is what the first leg may close with.
    std::optional<Debt> goal;
    if (second) goal = Debt{second->equation, -second->sign};
    auto leg = settle({uses[0].equation, uses[0].sign * change}, goal, cost, changed_);
    if (!leg) return false;
    for (const auto& step : leg->steps) apply(step.arc, step.change);
    if (!second || leg->closed) return true;
    leg = settle(*second, {}, cost, changed_);
    if (!leg) return false;
    for (const auto& step : leg->steps) apply(step.arc, step.change);
    return true;
  };
  const bool found = search();
  Circuit circuit;
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  for (const ArcId a : touched) {
    if (changed_[a.index] != 0) circuit.steps.push_back({a, changed_[a.index]});
    changed_[a.index] = 0;
  }
  if (!found || circuit.steps.empty()) return {};
  return circuit;
}

}  // namespace trimquad
