#pragma once

#include <functional>

#include "trimquad/base/progress.h"
#include "trimquad/quantize/deviation_flow.h"
#include "trimquad/quantize/separation.h"

namespace trimquad {

/// What is wrong with consistent lengths; nothing where they are valid.
using FaultSearch = std::function<std::vector<Collapse>(const ArcLengths& q)>;

struct Optimum {
  ArcLengths length;
  double lowerBound;  ///< no consistent, valid lengths within the bounds have a smaller objective
  bool proven;        ///< the lengths reach the bound
  long long work;     ///< branches times arcs
};

/// The least objective over all consistent, valid lengths within `bounds`. Starts from such lengths `q` and
/// the flow within the bounds. Branches on arcs of half lengths and on the arcs of a fault: one of them must
/// change. Goes straight down to valid lengths now and then, and else to the least bound. Gives up proving,
/// with the best lengths found so far, after `mostWork` branches times arcs.
Optimum leastLengths(const Dual& dual, const DoubleCover& cover, const FaultSearch& faults,
                     const ArcLengths& q, const LengthBounds& bounds, const DeviationFlow& flow,
                     long long mostWork, const Progress& progress);

}  // namespace trimquad
