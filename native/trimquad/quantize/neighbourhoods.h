#pragma once

#include "trimquad/quantize/branch_and_bound.h"

namespace trimquad {

/// Makes the objective of valid lengths smaller by large steps: around one arc after the other, what has a
/// length beyond its bound may lose it among the arcs nearest to it, and of the lengths that this allows the
/// best ones are searched by branching, which is quick as all others keep theirs above zero. Where no
/// neighbourhood gives better ones any more, they become twice as large, up to all arcs. Ends after
/// `mostWork` branches times arcs. (Large neighbourhood search) \param bounds  that all valid lengths keep
/// \return what of the work is left
long long improveInNeighbourhoods(const Dual& dual, const DoubleCover& cover, const FaultSearch& faults,
                                  const LengthBounds& bounds, long long mostWork, ArcLengths& q,
                                  const Progress& progress);

}  // namespace trimquad
