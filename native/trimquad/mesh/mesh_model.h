#pragma once

#include "trimquad/base/progress.h"
#include "trimquad/mesh/feature_options.h"
#include "trimquad/mesh/region.h"

namespace trimquad {

struct MeshModelOptions {
  /// Sharp edges are found by `sharpEdges`. Those that separate regions may be half a quad's edge short, those
  /// that become aligned two.
  FeatureOptions features = {};
  /// Degrees by which a boundary must turn for a corner, over every distance of one to four edges to both
  /// sides, so that the teeth of a jagged boundary do not count.
  double cornerAngle = 45;
};

/// A triangle mesh as a model; its triangles are the surface (Region::surface is null) and stay as they are,
/// but for splits within them: at feature points, and where constraints ask for it (see
/// splitConstrainedTriangles).
///
/// Every component is one region, "component K", and one shell; where sharp edges separate regions, as many
/// as they do, "component K part J". Components and regions are in the order of their first triangle; vertices
/// and triangles keep their order inside, new ones follow. A closed component bounds a solid. Boundary loops
/// ("loop:K", K in the order of their smallest halfedge) and borders between regions ("feature:K") become
/// curves, cut in corners and where they meet; a closed one without a corner starts in its smallest vertex.
/// All pieces of one loop have its name.
///
/// \param input  by triangle of `soup`: what Region::inputTriangle says of it; its number where empty
/// `soup` must be as `repair` leaves it. Throws Error(Input) if it is no oriented manifold, or where a chosen
/// edge or point is not there.
Model meshModel(const TriangleSoup& soup, const MeshModelOptions& options, const Progress& progress,
                std::vector<int> input = {});

}  // namespace trimquad
