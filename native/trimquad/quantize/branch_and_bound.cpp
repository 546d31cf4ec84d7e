#include "trimquad/quantize/branch_and_bound.h"

#include <memory>
#include <queue>

#include "trimquad/quantize/deviation_flow.h"

namespace trimquad {
namespace {

/// Objectives that differ by less are equal: the flow's costs are rounded.
constexpr double kEqual = 1e-5;

struct Branch {
  LengthBounds bounds;
  DeviationFlow flow;
  int number;
};

/// The one with the least bound first; the newer one of equals, which is deeper.
struct Later {
  bool operator()(const std::shared_ptr<Branch>& a, const std::shared_ptr<Branch>& b) const {
    if (a->flow.objective != b->flow.objective) return a->flow.objective > b->flow.objective;
    return a->number < b->number;
  }
};

class Search {
 public:
  Search(const Dual& dual, const Objective& objective, const SeparationTest& separation, const ArcLengths& q,
         long long mostWork)
      : dual_(dual),
        objective_(objective),
        separation_(separation),
        best_(q),
        bestObjective_(objective(q)),
        mostWork_(mostWork) {}

  Optimum run(const Progress& progress) && {
    add(boundsOfSeparation(dual_, separation_), best_);
    double bound = bestObjective_;
    while (!open_.empty()) {
      progress.check();
      const auto branch = open_.top();
      if (branch->flow.objective >= bestObjective_ - kEqual) return {best_, bestObjective_, true};
      if (count_ * (long long)(best_.size()) > mostWork_) {
        bound = branch->flow.objective;
        return {best_, bound, false};
      }
      open_.pop();
      split(*branch);
    }
    return {best_, bestObjective_, true};
  }

 private:
  void add(LengthBounds bounds, const ArcLengths& near) {
    auto flow = leastDeviation(dual_, objective_, bounds, near);
    if (!flow || flow->objective >= bestObjective_ - kEqual) return;
    open_.push(std::make_shared<Branch>(Branch{std::move(bounds), std::move(*flow), count_++}));
  }

  void split(const Branch& branch) {
    ArcLengths q;
    std::optional<ArcId> half;
    for (std::size_t a = 0; a < branch.flow.twice.size(); ++a) {
      q.push_back(branch.flow.twice[a] / 2);
      if (branch.flow.twice[a] % 2 != 0 && (!half || dual_.uses[a].size() < dual_.uses[half->index].size()))
        half = ArcId{int(a)};
    }
    if (half) {
      LengthBounds below = branch.bounds, above = branch.bounds;
      below.most[half->index] = q[half->index];
      above.least[half->index] = q[half->index] + 1;
      add(std::move(below), q);
      add(std::move(above), q);
      return;
    }
    const auto collapse = separation_.fault(q);
    if (!collapse) {
      const double objective = objective_(q);
      if (objective < bestObjective_) best_ = q, bestObjective_ = objective;
      return;
    }
    splitOn(branch, *collapse, q);
  }

  /// One of the collapse's arcs must have another length: the first does, or the first stays and the second
  /// does, ...
  void splitOn(const Branch& branch, const Collapse& collapse, const ArcLengths& q) {
    LengthBounds bounds = branch.bounds;
    splitOnLengths(collapse.zeroArcs, q, bounds);
    for (const ArcId a : collapse.mightVanish) {
      if (bounds.least[a.index] == 0) {
        LengthBounds zero = bounds;
        zero.most[a.index] = 0;
        add(std::move(zero), q);
      }
      bounds.least[a.index] = std::max(bounds.least[a.index], 1);
    }
    splitOnLengths(collapse.others, q, bounds);
  }

  void splitOnLengths(const std::vector<ArcId>& arcs, const ArcLengths& q, LengthBounds& bounds) {
    for (const ArcId a : arcs) {
      if (bounds.least[a.index] == bounds.most[a.index]) continue;
      LengthBounds above = bounds;
      above.least[a.index] = q[a.index] + 1;
      if (!above.most[a.index] || above.least[a.index] <= *above.most[a.index]) add(std::move(above), q);
      LengthBounds below = bounds;
      below.most[a.index] = q[a.index] - 1;
      if (below.least[a.index] <= *below.most[a.index]) add(std::move(below), q);
      bounds.least[a.index] = q[a.index];
      bounds.most[a.index] = q[a.index];
    }
  }

  const Dual& dual_;
  const Objective& objective_;
  const SeparationTest& separation_;
  ArcLengths best_;
  double bestObjective_;
  long long mostWork_;
  int count_ = 0;
  std::priority_queue<std::shared_ptr<Branch>, std::vector<std::shared_ptr<Branch>>, Later> open_;
};

}  // namespace

Optimum leastLengths(const Dual& dual, const Objective& objective, const SeparationTest& separation,
                     const ArcLengths& q, long long mostWork, const Progress& progress) {
  return Search(dual, objective, separation, q, mostWork).run(progress);
}

}  // namespace trimquad
