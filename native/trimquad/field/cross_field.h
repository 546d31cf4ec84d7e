#pragma once

#include <vector>

#include "trimquad/base/progress.h"
#include "trimquad/mesh/region.h"

namespace trimquad {

/// Four directions per triangle, a quarter turn apart.
struct CrossField {
  std::vector<Eigen::Vector3d>
      direction;  ///< by face index: one of the four, unit length, in the triangle's plane
  /// By halfedge index: by how many quarter turns direction[] jumps from the face to the opposite one beside
  /// the field's own smooth turn, which is at most 45 degrees. Antisymmetric. 0 on the boundary.
  std::vector<int> matching;
  std::vector<int> index;  ///< by vertex index: singularity index in quarter turns; 0 on the boundary
  /// Per boundary loop (in the order of boundaryLoops) how many quarter turns it makes against the field: 4
  /// for an outer loop of a plane region, -4 for a hole in it, 0 for an end of a tube.
  /// The turns of all loops and all indices add up to four times the Euler characteristic.
  std::vector<int> loopTurns;
  /// Aligned edges of the region that the field is parallel to: all but those between which a map would
  /// collapse. Ascending.
  std::vector<EdgeHandle> aligned;
  /// How much a map's distance to these directions weighs beside its distortion. Little: smooth directions
  /// need not be those of any map, and one that insists on them bends its quads; much where the user gave
  /// them.
  double follow = 0.2;
};

/// Directions that a field should follow, up to quarter turns.
struct FieldGuidance {
  std::vector<Eigen::Vector3d> direction;  ///< by face index, tangent; length does not matter
  std::vector<double> weight;              ///< by face index, in [0, 1]; 0 where there is no wish
};

/// A smooth field with as few singularities as smoothness asks for: parallel to the region's aligned edges in
/// the triangles beside them, free on the rest of the boundary, bent towards the guidance.
/// \param guidanceReach  the guidance takes over from smoothness at lengths above 1 / (this) of the square
/// root of the region's area; 0 ignores it
/// Throws Error(Stage, "field") for a triangle without area or with two aligned edges.
CrossField crossField(const Region& region, const FieldGuidance& guidance, double guidanceReach,
                      const Progress& progress);

/// Throws Error(Stage, "field") naming the first triangle that has no area, and so no directions.
void requireArea(const SurfaceMesh& mesh);

}  // namespace trimquad
