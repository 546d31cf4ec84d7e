#include "trimquad/quantize/quantize.h"

#include "trimquad/base/error.h"
#include "trimquad/quantize/branch_and_bound.h"
#include "trimquad/quantize/deviation_flow.h"
#include "trimquad/quantize/greedy.h"
#include "trimquad/quantize/short_loops.h"

namespace trimquad {
namespace {

/// Branches times arcs: milliseconds; finds most optima of T-meshes that are not large.
constexpr long long kWorkInPassing = 20000;
/// Some seconds, and some hundred megabytes.
constexpr long long kWorkForProof = 8000000;

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
  const auto flow = leastDeviation(cover, boundsOfSeparation(dual, separation), result.length);
  TRIMQUAD_ASSERT(flow);
  const auto improved = [&](ArcLengths other) {
    const int steps = improveGreedily(dual, objective, separation, other, progress);
    if (objective(other) < objective(result.length)) result.length = std::move(other), result.steps = steps;
  };
  if (auto other = separatedFlow(dual, cover, separation, *flow, progress)) improved(std::move(*other));
  Optimum optimum = leastLengths(dual, cover, separation, result.length, *flow,
                                 options.optimal ? kWorkForProof : kWorkInPassing, progress);
  if (!optimum.proven) improved(optimum.length);
  if (optimum.proven) result.length = std::move(optimum.length);
  result.lowerBound = optimum.lowerBound;
  if (options.widen) result.widened = widenLoops(dual, objective, separation, result.length, progress);
  if (options.optimal) result.method = optimum.proven && result.widened == 0 ? "optimal" : "bounded";
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
