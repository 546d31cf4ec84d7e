#include "trimquad/field/curvature_guidance.h"

#include <cmath>

#include "trimquad/field/bridged_guidance.h"
#include "trimquad/mesh/hole_bridges.h"
#include "trimquad/mesh/triangle_surface.h"

namespace trimquad {

FieldGuidance curvatureGuidance(const Region& region, const Progress& progress) {
  if (!region.bridge.empty()) return overBridges(curvatureGuidance(withoutBridges(region), progress), region);
  const auto& mesh = region.mesh;
  FieldGuidance guidance;
  guidance.direction.resize(mesh.n_faces());
  guidance.weight.resize(mesh.n_faces());
  const std::shared_ptr<const TrueSurface> surface =
      region.surface ? region.surface : std::make_shared<TriangleSurface>(mesh);
  const double size = std::sqrt(surfaceArea(mesh));
  for (const auto f : mesh.faces()) {
    if (f.idx() % 1024 == 0) progress.check();
    const auto curvature = surface->curvature(mesh.calc_face_centroid(f));
    guidance.direction[f.idx()] = curvature.direction1;
    const double bend = std::abs(curvature.k1 - curvature.k2) * size;
    guidance.weight[f.idx()] = std::isfinite(bend) ? bend * bend / (1 + bend * bend) : 0.0;
  }
  return guidance;
}

}  // namespace trimquad
