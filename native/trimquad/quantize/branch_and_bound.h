#pragma once

#include "trimquad/base/progress.h"
#include "trimquad/quantize/deviation_flow.h"
#include "trimquad/quantize/separation.h"

namespace trimquad {

struct Optimum {
  ArcLengths length;
  double lowerBound;  ///< no consistent, separating lengths have a smaller objective
  bool proven;        ///< the lengths reach the bound
};

/// The least objective over all consistent, separating lengths. Starts from valid lengths `q` and the flow
/// within the bounds of separation. Branches on arcs of half lengths and on the arcs of a collapse: one of
/// them must change. Goes straight down to valid lengths now and then, and else to the least bound. Gives up
/// proving, with the best lengths found so far, after `mostWork` branches times arcs.
Optimum leastLengths(const Dual& dual, const DoubleCover& cover, const SeparationTest& separation,
                     const ArcLengths& q, const DeviationFlow& flow, long long mostWork,
                     const Progress& progress);

}  // namespace trimquad
