#include "trimquad/quantize/branch_and_bound.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <queue>

namespace trimquad {
namespace {

/// Every so many branches, the search goes straight down.
constexpr int kBranchesPerDescent = 100;
constexpr double kNever = std::numeric_limits<double>::infinity();

struct Branch {
  LengthBounds bounds;
  DeviationFlow flow;
  int number;
  bool isSplit = false;
};
using BranchPointer = std::shared_ptr<Branch>;

/// The one with the least bound first; the newer one of equals, which is deeper.
struct Later {
  bool operator()(const BranchPointer& a, const BranchPointer& b) const {
    if (a->flow.objective != b->flow.objective) return a->flow.objective > b->flow.objective;
    return a->number < b->number;
  }
};

class Search {
 public:
  Search(const Dual& dual, const DoubleCover& cover, const FaultSearch& faults, const ArcLengths& q,
         long long mostWork)
      : dual_(dual),
        cover_(cover),
        faults_(faults),
        best_(q),
        bestObjective_(cover.objective()(q)),
        mostWork_(mostWork) {}

  Optimum run(const LengthBounds& bounds, const DeviationFlow& flow, const Progress& progress) && {
    if (flow.objective < bestObjective_ - Objective::kEqual)
      open_.push(std::make_shared<Branch>(Branch{bounds, flow, count_++}));
    int nextDescent = 0;
    while (!open_.empty()) {
      const BranchPointer branch = open_.top();
      if (branch->isSplit) {
        open_.pop();
        continue;
      }
      if (branch->flow.objective >= bestObjective_ - Objective::kEqual) break;
      if (isWorkDone()) return {best_, branch->flow.objective, false, work()};
      open_.pop();
      BranchPointer next = split(*branch, progress);
      if (count_ < nextDescent) continue;
      while (next && !isWorkDone() && next->flow.objective < bestObjective_ - Objective::kEqual)
        next = split(*next, progress);
      nextDescent = count_ + kBranchesPerDescent;
    }
    return {best_, bestObjective_, true, work()};
  }

 private:
  long long work() const { return count_ * (long long)(best_.size()); }
  bool isWorkDone() const { return work() > mostWork_; }

  /// Adds the parts that make up a branch. Returns the one with the least bound, none where there is none.
  BranchPointer split(Branch& branch, const Progress& progress) {
    progress.check();
    branch.isSplit = true;
    children_.clear();
    if (const auto half = halfArc(branch))
      splitOnHalf(branch, *half);
    else
      splitOnCollapse(branch);
    BranchPointer least;
    for (const BranchPointer& child : children_) {
      open_.push(child);
      if (!least || child->flow.objective < least->flow.objective) least = child;
    }
    return least;
  }

  void add(LengthBounds bounds, const Branch& parent) {
    auto flow = leastDeviation(cover_, bounds, parent.flow);
    ++count_;
    if (!flow || flow->objective >= bestObjective_ - Objective::kEqual) return;
    children_.push_back(std::make_shared<Branch>(Branch{std::move(bounds), std::move(*flow), count_}));
  }

  std::optional<ArcId> halfArc(const Branch& branch) const {
    std::optional<ArcId> half;
    for (std::size_t a = 0; a < branch.flow.twice.size(); ++a)
      if (branch.flow.twice[a] % 2 != 0 && (!half || dual_.uses[a].size() < dual_.uses[half->index].size()))
        half = ArcId{int(a)};
    return half;
  }

  void splitOnHalf(const Branch& branch, ArcId half) {
    const int below = branch.flow.twice[half.index] / 2;
    LengthBounds shorter = branch.bounds, longer = branch.bounds;
    shorter.most[half.index] = below;
    longer.least[half.index] = below + 1;
    add(std::move(shorter), branch);
    add(std::move(longer), branch);
  }

  void splitOnCollapse(const Branch& branch) {
    ArcLengths q;
    for (const int twice : branch.flow.twice) q.push_back(twice / 2);
    const auto faults = faults_(q);
    if (faults.empty()) {
      const double objective = cover_.objective()(q);
      if (objective < bestObjective_) best_ = q, bestObjective_ = objective;
      return;
    }
    // The collapse that is dearest to undo, and of these the one with the fewest ways.
    const Collapse* dearest = nullptr;
    std::pair<double, long> most{-1, 0};
    for (const Collapse& fault : faults) {
      const std::pair<double, long> price{leastPrice(branch, fault, q),
                                          -long(fault.zeroArcs.size() + fault.others.size())};
      if (!dearest || price > most) dearest = &fault, most = price;
    }
    splitOn(branch, *dearest, q);
  }

  /// What it costs at least to undo a collapse, by the potentials.
  double leastPrice(const Branch& branch, const Collapse& fault, const ArcLengths& q) const {
    double least = kNever;
    const auto offer = [&](ArcId a, int change) {
      const int to = q[a.index] + change;
      if (to < branch.bounds.least[a.index] ||
          (branch.bounds.most[a.index] && to > *branch.bounds.most[a.index]))
        return;
      least = std::min(least, branch.flow.cover.leastCost(cover_, a, change));
    };
    for (const ArcId a : fault.zeroArcs) offer(a, 1);
    for (const ArcId a : fault.mightVanish) offer(a, -1);
    for (const ArcId a : fault.others) offer(a, 1), offer(a, -1);
    return least;
  }

  /// One of the collapse's arcs must have another length: the first does, or the first stays and the second
  /// does, ...
  void splitOn(const Branch& branch, const Collapse& collapse, const ArcLengths& q) {
    LengthBounds bounds = branch.bounds;
    splitOnLengths(branch, collapse.zeroArcs, q, bounds);
    for (const ArcId a : collapse.mightVanish) {
      if (bounds.least[a.index] == 0) {
        LengthBounds zero = bounds;
        zero.most[a.index] = 0;
        add(std::move(zero), branch);
      }
      bounds.least[a.index] = std::max(bounds.least[a.index], 1);
    }
    splitOnLengths(branch, collapse.others, q, bounds);
  }

  void splitOnLengths(const Branch& branch, const std::vector<ArcId>& arcs, const ArcLengths& q,
                      LengthBounds& bounds) {
    for (const ArcId a : arcs) {
      if (bounds.least[a.index] == bounds.most[a.index]) continue;
      LengthBounds above = bounds;
      above.least[a.index] = q[a.index] + 1;
      if (!above.most[a.index] || above.least[a.index] <= *above.most[a.index]) add(std::move(above), branch);
      LengthBounds below = bounds;
      below.most[a.index] = q[a.index] - 1;
      if (below.least[a.index] <= *below.most[a.index]) add(std::move(below), branch);
      bounds.least[a.index] = q[a.index];
      bounds.most[a.index] = q[a.index];
    }
  }

  const Dual& dual_;
  const DoubleCover& cover_;
  const FaultSearch& faults_;
  ArcLengths best_;
  double bestObjective_;
  long long mostWork_;
  int count_ = 0;
  std::vector<BranchPointer> children_;  ///< of the branch that is being split
  std::priority_queue<BranchPointer, std::vector<BranchPointer>, Later> open_;
};

}  // namespace

Optimum leastLengths(const Dual& dual, const DoubleCover& cover, const FaultSearch& faults,
                     const ArcLengths& q, const LengthBounds& bounds, const DeviationFlow& flow,
                     long long mostWork, const Progress& progress) {
  return Search(dual, cover, faults, q, mostWork).run(bounds, flow, progress);
}

}  // namespace trimquad
