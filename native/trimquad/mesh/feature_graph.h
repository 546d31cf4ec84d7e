#pragma once

#include <optional>
#include <vector>

#include "trimquad/mesh/border_graph.h"
#include "trimquad/mesh/region.h"

namespace trimquad {

/// The aligned edges of a region as curves, and the vertices where these end, turn or meet.
struct FeatureGraph {
  std::vector<BorderChain> curves;  ///< see BorderGraph
  enum class Node {
    Point,     ///< a feature point that is none of the others
    End,       ///< one curve ends
    Corner,    ///< two meet: a curve turns by more than 45 degrees, or a closed one starts here
    Junction,  ///< three or more meet
  };
  std::vector<std::optional<Node>> node;  ///< by vertex

  int count(Node kind) const;
};

FeatureGraph featureGraph(const Region& region);

}  // namespace trimquad
