#pragma once

#include <algorithm>
#include <vector>

#include "trimquad/quantize/dual.h"

namespace trimquad {

/// Sum over all arcs of weight times squared difference to the target length. Weights are 1 / target, so that
/// relative differences of a given arc count more the longer it is; at least as of a quarter of a quad.
struct Objective {
  static constexpr double kShortest = 0.25;
  /// Objectives that differ by less are equal: the costs of flows are rounded.
  static constexpr double kEqual = 1e-5;

  std::vector<double> target;  ///< by arc, in quads
  std::vector<double> weight;

  /// \param virtualWeight factor for virtual arcs, which are no lengths on the surface
  Objective(const TMesh& tmesh, double virtualWeight) {
    for (const auto& arc : tmesh.arcs) {
      target.push_back(tmesh.scale.toQuads(arc.length));
      weight.push_back((arc.isVirtual ? virtualWeight : 1) / std::max(target.back(), kShortest));
    }
  }

  double of(ArcId a, double q) const {
    const double d = q - target[a.index];
    return weight[a.index] * d * d;
  }
  double operator()(const ArcLengths& q) const {
    double sum = 0;
    for (std::size_t a = 0; a < q.size(); ++a) sum += of({int(a)}, q[a]);
    return sum;
  }
};

}  // namespace trimquad
