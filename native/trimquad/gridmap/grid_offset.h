#pragma once

#include "trimquad/mesh/parametrization.h"

namespace trimquad {

/// How far to move a map that nothing binds to the grid, less than a quad in each direction: such that what
/// the boundary has along grid lines keeps away from them, for cells between a line and a boundary that all
/// but coincide are slivers.
FixedVector offsetOffBoundary(const Parametrization& map);

}  // namespace trimquad
