#pragma once

#include "trimquad/base/progress.h"
#include "trimquad/quantize/objective.h"
#include "trimquad/quantize/separation.h"

namespace trimquad {

/// Consistent lengths of one at least, already near the targets (QGP's first phase).
ArcLengths positiveLengths(const Dual& dual, const Objective& objective, const Progress& progress);

/// Changes lengths by circuits as long as one makes the objective smaller and keeps them separating (QGP's
/// second phase). Returns how many changes were made.
int improveGreedily(const Dual& dual, const Objective& objective, const SeparationTest& separation,
                    ArcLengths& q, const Progress& progress);

}  // namespace trimquad
