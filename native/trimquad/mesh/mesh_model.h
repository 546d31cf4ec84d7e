#pragma once

#include <optional>

#include "trimquad/base/progress.h"
#include "trimquad/mesh/region.h"

namespace trimquad {

struct MeshModelOptions {
  /// Degrees between two triangles' normals over which their edge is sharp and separates regions, where the
  /// sharp edges enclose one; nothing is cut without it.
  std::optional<double> trimAngle;
  /// Degrees by which a boundary must turn for a corner, over every distance of one to four edges to both
  /// sides, so that the teeth of a jagged boundary do not count.
  double cornerAngle = 45;
};

/// A triangle mesh as a model; its triangles are the surface (Region::surface is null) and stay as they are.
///
/// Every component is one region, "component K", and one shell; with `trimAngle`, as many regions as the
/// sharp edges separate, "component K part J". Components and regions are in the order of their first
/// triangle; vertices and triangles keep their order inside. A closed component bounds a solid. Boundary
/// loops ("loop:K", K in the order of their smallest halfedge) and borders between regions ("feature:K")
/// become curves, cut in corners and where they meet; a closed one without a corner starts in its smallest
/// vertex. All pieces of one loop have its name.
///
/// `soup` must be as `repair` leaves it; throws Error(Input) if it is no oriented manifold.
Model meshModel(const TriangleSoup& soup, const MeshModelOptions& options, const Progress& progress);

}  // namespace trimquad
