#include "trimquad/seamless/seamless_map.h"

#include <cmath>

#include "trimquad/base/error.h"
#include "trimquad/mesh/boundary_image.h"
#include "trimquad/seamless/solve_map.h"

namespace trimquad {
namespace {

MapTarget mapTarget(const SurfaceMesh& mesh, const CrossField& field, double edgeLength) {
  MapTarget target(mesh.n_faces());
  for (const auto f : mesh.faces()) {
    HalfedgeHandle h = mesh.halfedge_handle(f);
    std::array<Eigen::Vector3d, 3> p;
    for (int k = 0; k < 3; ++k, h = mesh.next_halfedge_handle(h))
      p[k] = mesh.point(mesh.from_vertex_handle(h));
    const Eigen::Vector3d normal = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
    const Eigen::Vector3d u = field.direction[f.idx()], v = normal.cross(u);
    for (int k = 0; k < 3; ++k)
      target[f.idx()][k] = Eigen::Vector2d((p[k] - p[0]).dot(u), (p[k] - p[0]).dot(v)) / edgeLength;
  }
  return target;
}

/// Whether the boundary's image, of a map in one chart, meets itself: then the map covers a part of the plane
/// twice.
bool overlaps(const Parametrization& map) {
  std::vector<BoundarySegment> segments;
  for (const auto& loop : boundaryLoops(map.mesh)) {
    const int base = int(segments.size()), size = int(loop.size());
    for (int i = 0; i < size; ++i) {
      const auto inner = map.mesh.opposite_halfedge_handle(loop[size - 1 - i]);
      segments.push_back({map.from(inner), map.to(inner), base + (i + 1) % size});
    }
  }
  return firstContact(segments, std::nullopt).has_value();
}

}  // namespace

SeamlessMap seamlessMap(const Region& region, const CrossField& field, double edgeLength,
                        const Progress& progress) {
  if (!(edgeLength > 0) || !std::isfinite(edgeLength))
    throw inputError("seamless", "the edge length must be a positive number");
  const auto& mesh = region.mesh;
  const MapTarget target = mapTarget(mesh, field, edgeLength);
  const SeamGraph seams = seamGraph(mesh, field);
  // A tube's period lies along one axis: whichever the unconstrained map follows more. An oblique one would
  // make the grid wind around the tube like a thread.
  std::vector<BranchTranslation> translations(seams.rotation.size());
  if (!translations.empty()) {
    const SeamBasis free(mesh, seams, translations);
    const Eigen::VectorXd z = poissonMap(mesh, target, free);
    const Eigen::VectorXd x = free.basis().matrix() * z + free.basis().offset();
    for (int b = 0; b < int(translations.size()); ++b) {
      const bool alongU = std::abs(x[free.translation(b, 0)]) >= std::abs(x[free.translation(b, 1)]);
      translations[b][alongU ? 1 : 0] = 0;
    }
  }
  const SeamBasis basis(mesh, seams, translations);
  SeamlessMap map;
  const Eigen::VectorXd z =
      solveMap(mesh, seams, target, field.index, basis, "seamless", map.counters, progress);
  static_cast<Parametrization&>(map) = exactMap(mesh, basis, z, false);
  // A map in one chart can serve as the parameter plane of one trimmed surface, as long as it is one to one.
  if (seams.rotation.empty() && overlaps(map)) {
    map.counters.scaffolded = true;
    const Eigen::VectorXd apart = oneToOneMap(mesh, seams, target, basis, map.counters, progress);
    static_cast<Parametrization&>(map) = exactMap(mesh, basis, apart, false);
  }
  map.seams = seams;
  map.target = target;
  map.index = field.index;
  return map;
}

}  // namespace trimquad
