#pragma once

#include "trimquad/base/progress.h"
#include "trimquad/quantize/objective.h"
#include "trimquad/quantize/separation.h"

namespace trimquad {

struct Optimum {
  ArcLengths length;
  double lowerBound;  ///< no consistent, separating lengths have a smaller objective
  bool proven;        ///< the lengths reach the bound
};

/// The least objective over all consistent, separating lengths. Starts from valid lengths `q`. Branches, from
/// the least-cost flow, on arcs of half lengths and on the arcs of a collapse: one of them must change. Gives
/// up proving, with the best lengths found so far, after `mostWork` branches times arcs.
Optimum leastLengths(const Dual& dual, const Objective& objective, const SeparationTest& separation,
                     const ArcLengths& q, long long mostWork, const Progress& progress);

}  // namespace trimquad
