#pragma once

#include <optional>
#include <string>

#include "trimquad/base/progress.h"
#include "trimquad/quantize/separation.h"

namespace trimquad {

struct QuantizationOptions {
  Separation separation = Separation::Free;
  bool optimal = false;        ///< search on until the objective is proven to be least
  bool widen = true;           ///< three quads at least around handles and necks: see `widenLoops`
  double virtualWeight = 0.1;  ///< of virtual arcs in the objective, relative to real ones
};

/// Integer lengths for the arcs of a T-mesh (paper, section 5): consistent (every patch stays a rectangle)
/// and separating (a grid map with these lengths exists).
struct Quantization {
  ArcLengths length;  ///< by arc, in quads
  /// "greedy"; "optimal" where proven; "bounded" where the search for a proof was given up
  std::string method;
  double objective = 0;   ///< see `Objective`
  double lowerBound = 0;  ///< no lengths that keep the same rules have a smaller objective
  int steps = 0;          ///< changes that improved the objective
  int widened = 0;        ///< and those that made room around handles and necks
  int zeroArcs = 0, zeroPatches = 0;
};

/// Lengths near the arcs' target lengths: strictly positive ones, improved by elementary circuits as long as
/// they stay separating; the least-cost flow, with its collapses repaired and improved in the same way; then,
/// from the better of the two, a search that branches from the flow, short in general and long with
/// `optimal`, and where that proves nothing in the neighbourhoods of arcs. Afterwards `widenLoops`, unless it
/// is switched off, and the same search among lengths without short loops. Throws Error(Stage, "quantize")
/// where the T-mesh admits no positive lengths.
Quantization quantize(const TMesh& tmesh, const QuantizationOptions& options, const Progress& progress);

}  // namespace trimquad
