#pragma once

#include <vector>

#include "trimquad/base/progress.h"
#include "trimquad/mesh/region.h"

namespace trimquad {

/// Four directions per triangle, a quarter turn apart.
struct CrossField {
  std::vector<Eigen::Vector3d>
      direction;  ///< by face index: one of the four, unit length, in the triangle's plane
  /// By halfedge index: quarter turns that take the face's direction to the opposite face's nearest one: the
  /// field turns by matching * 90 degrees from direction[f] to direction[g] when crossing h from f to g.
  /// Interior edges only.
  std::vector<int> matching;
  std::vector<int> index;  ///< by vertex index: singularity index in quarter turns
  /// Per boundary loop (in the order of boundaryLoops) how many full turns it makes against the field: 1 for
  /// an outer loop, -1 for a hole, 0 for an end of a tube.
  std::vector<int> loopTurns;
};

/// Directions that a field should follow, up to quarter turns.
struct FieldGuidance {
  std::vector<Eigen::Vector3d> direction;  ///< by face index, tangent; length does not matter
  std::vector<double> weight;              ///< by face index, in [0, 1]; 0 where there is no wish
};

/// The smoothest field without singularities, following principal curvature where it is distinct.
/// Only for regions of genus 0 with a boundary; throws Error(Stage) for others, which need singularities.
CrossField crossField(const Region& region, const Progress& progress);

}  // namespace trimquad
