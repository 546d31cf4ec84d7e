#pragma once

#include "trimquad/base/progress.h"
#include "trimquad/brep/shape.h"
#include "trimquad/mesh/feature_options.h"
#include "trimquad/mesh/region.h"

namespace trimquad {

struct TessellateOptions {
  double edgeLength = 1;    ///< of the triangles, model units
  double tolerance = 1e-3;  ///< wanted distance between triangles and surface, model units
  FeatureOptions features = {.sharp = FeatureOptions::Sharp::Trim};
};

/// A CAD shape as triangle meshes of about the wanted edge length, smaller where curvature asks for it: one
/// region per part between sharp and free edges, across smooth CAD edges and across aligned edges that do not
/// separate; these stay chains of mesh edges. Feature points are vertices, and triangles are split as
/// `splitConstrainedTriangles` says.
///
/// Loose faces that touch are sewn first, but where that makes up no surface (three in one edge, one side
/// only) all of them stay apart, a region each: Model::keptApart.
///
/// Guarantees: regions are oriented manifolds, outward for solids; inner vertices lie on the true surface;
/// both sides of a common edge have the same vertices; edges and faces are named as FreeCAD counts them. No
/// triangle has all its vertices on the boundary, where the region allows it. Throws Error(Input,
/// "tessellate") for options that are not positive numbers, (Input, "options") for chosen edges, vertices and
/// points that are not there, for edges with more than two faces, one-sided
/// surfaces and faces that cannot be triangulated; Error(Stage, "tessellate") where remeshing fails.
Model tessellate(const Shape& shape, const TessellateOptions& options, const Progress& progress);

}  // namespace trimquad
