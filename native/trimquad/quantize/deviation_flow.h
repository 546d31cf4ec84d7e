#pragma once

#include <optional>

#include "trimquad/base/progress.h"
#include "trimquad/quantize/cover_flow.h"
#include "trimquad/quantize/separation.h"

namespace trimquad {

/// The bounds that every separating quantization keeps.
LengthBounds boundsOfSeparation(const Dual& dual, const SeparationTest& separation);

/// Least objective over consistent lengths, whole and half ones, within bounds; separation is not asked for.
/// A lower bound for whole lengths.
struct DeviationFlow {
  double objective;
  std::vector<int> twice;  ///< twice the lengths, by arc
  CoverFlow cover;
};

/// Consistent lengths are a bidirected flow; on the double cover of the dual they are an ordinary one, and a
/// least-cost flow there gives the half-integral optimum (Heistermann et al. 2023, "Min-Deviation-Flow in
/// Bi-directed Graphs"). Lengths near `start` are searched first. None where no lengths fit the bounds.
std::optional<DeviationFlow> leastDeviation(const DoubleCover& cover, const LengthBounds& bounds,
                                            const ArcLengths& start);

/// The same from the flow within other bounds; as costly as these differ.
std::optional<DeviationFlow> leastDeviation(const DoubleCover& cover, const LengthBounds& bounds,
                                            const DeviationFlow& near);

/// Consistent, separating lengths: the least-cost flow within the bounds of separation, again and again with
/// an arc of each collapse kept from vanishing. None where that leads nowhere.
std::optional<ArcLengths> separatedFlow(const Dual& dual, const DoubleCover& cover,
                                        const SeparationTest& separation, const DeviationFlow& flow,
                                        const Progress& progress);

}  // namespace trimquad
