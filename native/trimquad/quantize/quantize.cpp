#include "trimquad/quantize/quantize.h"

#include <tuple>

#include "trimquad/base/error.h"
#include "trimquad/quantize/branch_and_bound.h"
#include "trimquad/quantize/deviation_flow.h"
#include "trimquad/quantize/greedy.h"
#include "trimquad/quantize/neighbourhoods.h"
#include "trimquad/quantize/short_loops.h"

namespace trimquad {
namespace {

/// Branches times arcs: milliseconds; finds most optima of T-meshes that are not large.
constexpr long long kWorkInPassing = 20000;
/// Tenths of a second, where those have not sufficed.
constexpr long long kWorkNearby = 250000;
/// Where lengths have short loops, which is rare: these are far more expensive than need be at first.
constexpr long long kWorkWidened = 2000000;
/// The same, and for a proof, with `optimal`: some seconds, and some hundred megabytes.
constexpr long long kWorkNearbyForBest = 4000000, kWorkForProof = 8000000;
/// Looking for short loops costs as much as branching while there are no more quads than this.
constexpr long long kQuadsPerWork = 1000;

/// Valid lengths are searched by branching: in passing, then around one arc after the other, then from the
/// flow again.
class BestLengths {
 public:
  BestLengths(const Dual& dual, const DoubleCover& cover, const SeparationTest& separation, bool optimal,
              const Progress& progress)
      : dual_(dual),
        cover_(cover),
        bounds_(boundsOfSeparation(dual, separation)),
        optimal_(optimal),
        progress_(progress) {}

  DeviationFlow flow(const ArcLengths& start) const {
    auto flow = leastDeviation(cover_, bounds_, start);
    TRIMQUAD_ASSERT(flow);
    return std::move(*flow);
  }

  /// Makes valid lengths better. Returns the bound, and whether they reach it.
  /// \param workNearby  unless the best ones are wanted
  /// \param costOfTest  of valid lengths: that of so many branches
  std::pair<double, bool> improve(const FaultSearch& faults, const DeviationFlow& flow, long long workNearby,
                                  long long costOfTest, ArcLengths& q) const {
    const auto branch = [&](long long work) {
      return leastLengths(dual_, cover_, faults, q, bounds_, flow, work, progress_);
    };
    Optimum optimum = branch(kWorkInPassing / costOfTest);
    if (!optimum.proven) {
      const long long work = (optimal_ ? kWorkNearbyForBest : workNearby) / costOfTest;
      const long long left =
          improveInNeighbourhoods(dual_, cover_, faults, bounds_, work, optimum.length, progress_);
      q = optimum.length;
      optimum = branch(optimal_ ? kWorkForProof / costOfTest : left);
    }
    q = std::move(optimum.length);
    return {optimum.lowerBound, optimum.proven};
  }

 private:
  const Dual& dual_;
  const DoubleCover& cover_;
  const LengthBounds bounds_;
  const bool optimal_;
  const Progress& progress_;
};

long long quadCount(const TMesh& tmesh, const ArcLengths& q) {
  long long count = 0;
  for (const auto& patch : tmesh.patches)
    count += (long long)(lengthOf(patch.sides[0], q)) * lengthOf(patch.sides[1], q);
  return count;
}

}  // namespace

Quantization quantize(const TMesh& tmesh, const QuantizationOptions& options, const Progress& progress) {
  const Dual dual(tmesh);
  const Objective objective(tmesh, options.virtualWeight);
  const SeparationTest separation(dual, options.separation);
  Quantization result;
  result.method = "greedy";
  result.length = positiveLengths(dual, objective, progress);
  result.steps = improveGreedily(dual, objective, separation, result.length, progress);
  const DoubleCover cover(dual, objective);
  const BestLengths best(dual, cover, separation, options.optimal, progress);
  const DeviationFlow flow = best.flow(result.length);
  if (auto other = separatedFlow(dual, cover, separation, flow, progress)) {
    const int steps = improveGreedily(dual, objective, separation, *other, progress);
    if (objective(*other) < objective(result.length)) result.length = std::move(*other), result.steps = steps;
  }
  const FaultSearch collapses = [&](const ArcLengths& q) { return separation.faults(q); };
  auto [bound, proven] = best.improve(collapses, flow, kWorkNearby, 1, result.length);
  result.widened = options.widen ? widenLoops(dual, objective, separation, result.length, progress) : 0;
  if (result.widened > 0) {
    const FaultSearch all = [&](const ArcLengths& q) {
      auto faults = separation.faults(q);
      return faults.empty() ? shortLoopFaults(tmesh, q) : faults;
    };
    const long long costOfTest = 1 + quadCount(tmesh, result.length) / kQuadsPerWork;
    std::tie(bound, proven) = best.improve(all, flow, kWorkWidened, costOfTest, result.length);
  }
  result.lowerBound = bound;
  if (options.optimal) result.method = proven ? "optimal" : "bounded";
  TRIMQUAD_ASSERT(isConsistent(dual, result.length));
  TRIMQUAD_ASSERT(!separation.fault(result.length));
  result.objective = objective(result.length);
  for (const int q : result.length) result.zeroArcs += q == 0;
  for (const auto& patch : tmesh.patches)
    result.zeroPatches +=
        lengthOf(patch.sides[0], result.length) == 0 || lengthOf(patch.sides[1], result.length) == 0;
  return result;
}

}  // namespace trimquad
