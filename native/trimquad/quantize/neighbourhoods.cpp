#include "trimquad/quantize/neighbourhoods.h"

#include <algorithm>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

/// Arcs of the first neighbourhoods.
constexpr std::size_t kFirstSize = 30;
/// This part of a neighbourhood, the nearest arcs, are not tried again as centres.
constexpr std::size_t kCore = 4;
/// Branches for each arc of a neighbourhood at most.
constexpr long long kBranchesPerArc = 3;

class NeighbourhoodSearch {
 public:
  NeighbourhoodSearch(const Dual& dual, const DoubleCover& cover, const FaultSearch& faults,
                      const LengthBounds& bounds, long long mostWork, ArcLengths& q)
      : dual_(dual), cover_(cover), faults_(faults), widest_(bounds), workLeft_(mostWork), q_(q) {
    tighten();
  }

  long long run(const Progress& progress) {
    for (std::size_t size = kFirstSize;; size *= 2) {
      waiting_.assign(q_.size(), true);
      for (bool improved = true; improved;) {
        improved = false;
        for (const ArcId a : byDeviation()) {
          if (!waiting_[a.index]) continue;
          if (workLeft_ <= 0) return 0;
          if (improveAround(a, size, progress)) improved = true;
        }
      }
      if (size >= q_.size()) return workLeft_;
    }
  }

 private:
  /// All arcs that have a length keep one.
  void tighten() {
    tight_ = widest_;
    for (std::size_t a = 0; a < q_.size(); ++a)
      tight_.least[a] = std::max(tight_.least[a], std::min(q_[a], 1));
    auto flow = leastDeviation(cover_, tight_, q_);
    TRIMQUAD_ASSERT(flow);
    flow_ = std::move(*flow);
  }

  /// The arcs that are farthest from their targets first.
  std::vector<ArcId> byDeviation() const {
    std::vector<ArcId> order;
    for (std::size_t a = 0; a < q_.size(); ++a) order.push_back({int(a)});
    const Objective& objective = cover_.objective();
    std::stable_sort(order.begin(), order.end(), [&](ArcId a, ArcId b) {
      return objective.of(a, q_[a.index]) > objective.of(b, q_[b.index]);
    });
    return order;
  }

  /// The arc and those nearest to it across patches, in this order.
  std::vector<ArcId> around(ArcId centre, std::size_t size) const {
    std::vector<ArcId> near{centre};
    std::vector<bool> reached(q_.size(), false);
    reached[centre.index] = true;
    for (std::size_t k = 0; k < near.size() && near.size() < size; ++k)
      for (const auto& use : dual_.uses[near[k].index])
        for (const int axis : {0, 1})
          for (const auto& term : dual_[EquationId::of(use.equation.patch(), axis)])
            if (!reached[term.arc.index]) reached[term.arc.index] = true, near.push_back(term.arc);
    return near;
  }

  /// Whether the flow would have the arc shorter if it might.
  bool isHeld(ArcId a) const {
    const int least = tight_.least[a.index];
    const auto& flow = flow_.cover.flow[a.index];
    return widest_.least[a.index] < least && (flow[0] == least || flow[1] == least);
  }

  bool improveAround(ArcId centre, std::size_t size, const Progress& progress) {
    progress.check();
    const auto near = around(centre, size);
    for (std::size_t k = 0; k < std::min(near.size(), size / kCore); ++k) waiting_[near[k].index] = false;
    if (std::none_of(near.begin(), near.end(), [&](ArcId a) { return isHeld(a); })) return false;
    LengthBounds bounds = tight_;
    for (const ArcId a : near) bounds.least[a.index] = widest_.least[a.index];
    const auto arcs = (long long)(q_.size());
    workLeft_ -= arcs;
    const auto flow = leastDeviation(cover_, bounds, flow_);
    TRIMQUAD_ASSERT(flow);
    const double before = cover_.objective()(q_);
    if (flow->objective > before - Objective::kEqual) return false;
    const long long most = std::min((long long)(size)*kBranchesPerArc * arcs, workLeft_);
    Optimum found = leastLengths(dual_, cover_, faults_, q_, bounds, *flow, most, progress);
    workLeft_ -= found.work;
    if (cover_.objective()(found.length) > before - Objective::kEqual) return false;
    q_.swap(found.length);
    for (std::size_t a = 0; a < q_.size(); ++a)
      if (q_[a] != found.length[a])
        for (const ArcId b : around({int(a)}, size)) waiting_[b.index] = true;
    tighten();
    return true;
  }

  const Dual& dual_;
  const DoubleCover& cover_;
  const FaultSearch& faults_;
  const LengthBounds& widest_;
  long long workLeft_;
  ArcLengths& q_;
  LengthBounds tight_;
  DeviationFlow flow_;         ///< within the tight bounds
  std::vector<bool> waiting_;  ///< by arc: may be the centre of a neighbourhood
};

}  // namespace

long long improveInNeighbourhoods(const Dual& dual, const DoubleCover& cover, const FaultSearch& faults,
                                  const LengthBounds& bounds, long long mostWork, ArcLengths& q,
                                  const Progress& progress) {
  return NeighbourhoodSearch(dual, cover, faults, bounds, mostWork, q).run(progress);
}

}  // namespace trimquad
