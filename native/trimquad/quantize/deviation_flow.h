#pragma once

#include <optional>

#include "trimquad/base/progress.h"
#include "trimquad/quantize/objective.h"
#include "trimquad/quantize/separation.h"

namespace trimquad {

/// Bounds on the length of each arc.
struct LengthBounds {
  std::vector<int> least;
  std::vector<std::optional<int>> most;
};

/// The bounds that every separating quantization keeps.
LengthBounds boundsOfSeparation(const Dual& dual, const SeparationTest& separation);

/// Least objective over consistent lengths, whole and half ones, within bounds; separation is not asked for.
/// A lower bound for whole lengths.
struct DeviationFlow {
  double objective;
  std::vector<int> twice;  ///< twice the lengths, by arc
};

/// Consistent lengths are a bidirected flow; on the double cover of the dual they are an ordinary one, and a
/// least-cost flow there gives the half-integral optimum (Heistermann et al. 2023, "Min-Deviation-Flow in
/// Bi-directed Graphs"). Lengths near `start` are searched first. None where no lengths fit the bounds.
std::optional<DeviationFlow> leastDeviation(const Dual& dual, const Objective& objective,
                                            const LengthBounds& bounds, const ArcLengths& start);

/// Consistent, separating lengths: the least-cost flow, again and again with an arc of each collapse kept
/// from vanishing. None where that leads nowhere.
std::optional<ArcLengths> separatedFlow(const Dual& dual, const Objective& objective,
                                        const SeparationTest& separation, const ArcLengths& start,
                                        const Progress& progress);

}  // namespace trimquad
