#pragma once

#include <optional>

#include "trimquad/quantize/objective.h"

namespace trimquad {

/// Bounds on the length of each arc.
struct LengthBounds {
  std::vector<int> least;
  std::vector<std::optional<int>> most;
};

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

}  // namespace trimquad
