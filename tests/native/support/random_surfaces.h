#pragma once

#include <random>

#include "support/sample_maps.h"
#include "trimquad/tmesh/isoline.h"

namespace trimquad::samples {

bool connected(const SurfaceMesh& mesh);

/// Takes out about `count` random triangles and their neighbours, as long as the rest stays a connected
/// manifold.
MappedSoup pierced(MappedSoup mapped, int count, std::mt19937& random);

/// Moves the images of random vertices by whole multiples of `unit` quanta, where no triangle turns over.
/// Singular vertices stay.
void jitter(Parametrization& map, Quanta unit, int amplitude, std::mt19937& random);

/// Random edges that lie along the axes become aligned, all of them that are one straight run or only some.
void alignSome(Parametrization& map, unsigned oneIn, std::mt19937& random);

void markSome(Parametrization& map, unsigned oneIn, std::mt19937& random);

/// A random plane domain with holes on a coarse lattice, so that iso-lines meet vertices and edges and each
/// other.
GridMap randomDomain(std::mt19937& random);

/// A cone, tube or torus with random holes and vertices moved about.
GridMap randomSingularSurface(std::mt19937& random);

}  // namespace trimquad::samples
