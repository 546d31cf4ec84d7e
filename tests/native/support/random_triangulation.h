#pragma once

#include <random>

#include "trimquad/gridmap/grid_map.h"

namespace trimquad::samples {

/// The map of a random plane triangulation on a coarse lattice, which may overlap itself: up to `mostSteps` -
/// 1 insertions, flips and ears, then attempts at up to `mostHoles` - 1 holes. It may consist of several
/// parts.
GridMap randomTriangulation(std::mt19937& random, unsigned mostSteps, unsigned mostHoles);

}  // namespace trimquad::samples
