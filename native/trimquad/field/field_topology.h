#pragma once

#include "trimquad/field/cross_field.h"
#include "trimquad/field/transport.h"

namespace trimquad {

/// Fills in the matchings, indices and loop turns of a field that has its directions only: across every edge
/// the field makes the smallest turn, unless a vertex would get an index of 3 or more, a single quad or
/// none: that is shared with its neighbours. Asserts that indices and turns add up to the Euler
/// characteristic (Poincare-Hopf).
void settleTopology(const SurfaceMesh& mesh, const Transport& transport, CrossField& field);

}  // namespace trimquad
