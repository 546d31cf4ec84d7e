#pragma once

#include "trimquad/field/cross_field.h"

namespace trimquad {

/// Whether the mesh is of genus 0 with a boundary, so that a field without singularities exists that plane
/// charts can follow.
bool admitsNoSingularity(const SurfaceMesh& mesh);

/// The smoothest field without singularities of those that a plane region with holes or a tube has (loopTurns
/// 4 for an outer loop, -4 for a hole, 0 for the two ends of a tube), bent towards the guidance within its
/// homotopy class. \param guidanceReach  see crossField \pre admitsNoSingularity(mesh)
CrossField singularityFreeField(const SurfaceMesh& mesh, const FieldGuidance& guidance, double guidanceReach,
                                const Progress& progress);

}  // namespace trimquad
