#include "trimquad/mesh/join_regions.h"
#include "trimquad/mesh/remesh.h"
#include "trimquad/mesh/split_triangles.h"

// This order: OpenCASCADE's macros must not reach the mesh headers.
#include "trimquad/brep/meshed_regions.h"

namespace trimquad {
namespace {

/// Marks the aligned edges of the boundaries, and the vertices that were wanted on curves.
void markConstraints(CutModel& cut, const std::vector<CurvePoint>& points) {
  for (auto& region : cut.model.regions) {
    for (const auto e : region.mesh.edges())
      if (const auto& curve = region.edgeCurve[e.idx()]; curve && cut.aligned[curve->index])
        region.aligned.push_back(e);
    markCurvePoints(region, points);
  }
}

}  // namespace

Model meshedRegions(CutModel& cut, const std::vector<CurvePoint>& points,
                    const std::vector<std::vector<double>>& division, const RemeshOptions& options,
                    const Progress& progress) {
  for (auto& region : cut.model.regions) remesh(region, cut.model, division, options, progress);
  markConstraints(cut, points);
  Model model = joinRegions(cut.model, cut.inner, cut.surfaces);
  for (auto& region : model.regions) splitConstrainedTriangles(region);
  return model;
}

}  // namespace trimquad
