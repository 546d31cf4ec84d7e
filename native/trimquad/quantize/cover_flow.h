#pragma once

#include <array>
#include <optional>
#include <vector>

#include "trimquad/quantize/objective.h"

namespace trimquad {

/// Bounds on the length of each arc.
struct LengthBounds {
  std::vector<int> least;
  std::vector<std::optional<int>> most;
};

/// The graph whose least-cost flows are the half-integral least lengths: each equation of the dual as two
/// nodes, each arc as two edges, the second with all signs reversed; border arcs end in one more node.
class DoubleCover {
 public:
  using Cost = long long;
  struct Edge {
    int tail, head;
  };

  DoubleCover(const Dual& dual, const Objective& objective);

  int nodeCount() const { return int(incident_.size()); }
  int arcCount() const { return int(edges_.size() / 2); }
  Edge edge(ArcId a, int copy) const { return edges_[std::size_t(2 * a.index + copy)]; }
  /// Edges that end in a node, as 2 * arc + copy; loops left out.
  const std::vector<int>& incident(int node) const { return incident_[std::size_t(node)]; }
  /// Cost of one quad more than `q`, rounded.
  Cost slope(ArcId a, int q) const;
  const Objective& objective() const { return objective_; }

 private:
  const Objective& objective_;
  std::vector<Edge> edges_;
  std::vector<std::vector<int>> incident_;
};

/// A flow of least cost and the potentials that prove it: no edge can be changed by one at a negative reduced
/// cost.
struct CoverFlow {
  std::vector<std::array<int, 2>> flow;      ///< by arc, both its edges
  std::vector<DoubleCover::Cost> potential;  ///< by node

  /// Cost of a change by +1 or -1 of both edges of an arc, at least; in the objective's unit.
  double leastCost(const DoubleCover& cover, ArcId a, int change) const;
};

/// The flow of least cost within bounds, from one that is so within others: what violates the bounds or the
/// potentials is moved, and balance restored along shortest paths. As costly as the bounds differ. None where
/// nothing fits the bounds.
std::optional<CoverFlow> reoptimized(const DoubleCover& cover, const LengthBounds& bounds, CoverFlow flow);

}  // namespace trimquad
