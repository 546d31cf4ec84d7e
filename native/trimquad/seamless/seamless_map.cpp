#include "trimquad/seamless/seamless_map.h"

#include <algorithm>
#include <cmath>

#include "trimquad/base/error.h"
#include "trimquad/mesh/boundary_image.h"
#include "trimquad/seamless/newton.h"
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

/// How far, in quads, one end of a tube runs along the field's two directions on its way around.
Eigen::Vector2d lengthAlongEnd(const SurfaceMesh& mesh, const CrossField& field, const MapTarget& target) {
  const auto loops = boundaryLoops(mesh);
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  const auto end = std::find(field.loopTurns.begin(), field.loopTurns.end(), 0) - field.loopTurns.begin();
  for (const auto boundary : loops[size_t(end)]) {
    const auto inner = mesh.opposite_halfedge_handle(boundary);
    const auto f = mesh.face_handle(inner);
    int k = 0;
    for (auto h = mesh.halfedge_handle(f); h != inner; h = mesh.next_halfedge_handle(h)) ++k;
    sum += target[f.idx()][(k + 1) % 3] - target[f.idx()][k];
  }
  return sum;
}

/// Whether the boundary's image meets itself: then the map covers a part of the plane (rolled up in the
/// direction of a tube's period) twice.
bool overlaps(const Parametrization& map, const SeamGraph& seams) {
  std::optional<FixedVector> period;
  for (const auto h : map.mesh.halfedges())
    if (const auto& crossing = seams.crossing[h.idx()]; crossing && crossing->forward)
      period = map.transition(h).translation;
  const int turn = period && period->u == 0 ? 1 : 0;  // the test rolls the plane up in u
  std::vector<BoundarySegment> segments;
  for (const auto& loop : boundaryLoops(map.mesh)) {
    const int base = int(segments.size()), size = int(loop.size());
    for (int i = 0; i < size; ++i) {
      const auto inner = map.mesh.opposite_halfedge_handle(loop[size - 1 - i]);
      segments.push_back(
          {rotated(map.from(inner), turn), rotated(map.to(inner), turn), base + (i + 1) % size});
    }
  }
  std::optional<Quanta> around;
  if (period) around = std::abs(turn ? period->v : period->u);
  return firstContact(segments, around).has_value();
}

/// The seams of a plane region, whatever the field: none. The outer loop is the field's, or the longer end of
/// its tube.
SeamGraph withoutSeams(const SurfaceMesh& mesh, const CrossField& field) {
  SeamGraph seams;
  seams.crossing.resize(mesh.n_halfedges());
  const auto loops = boundaryLoops(mesh);
  double longest = -1;
  for (int l = 0; l < int(loops.size()); ++l) {
    double length = 0;
    for (const auto h : loops[l]) length += mesh.calc_edge_length(h);
    if (field.loopTurns[l] < 0 || length <= longest) continue;
    longest = length;
    seams.outerLoop = l;
  }
  return seams;
}

}  // namespace

SeamlessMap seamlessMap(const Region& region, const CrossField& field, double edgeLength,
                        const Progress& progress) {
  if (!(edgeLength > 0) || !std::isfinite(edgeLength))
    throw inputError("seamless", "the edge length must be a positive number");
  const auto& mesh = region.mesh;
  const MapTarget target = mapTarget(mesh, field, edgeLength);
  const SeamGraph seams = seamGraph(mesh, field);
  // A tube's period lies along one axis: the one that its ends follow more. An oblique one would make the
  // grid wind around the tube like a thread.
  std::vector<BranchTranslation> translations(seams.rotation.size());
  if (!translations.empty()) {
    const Eigen::Vector2d around = lengthAlongEnd(mesh, field, target);
    translations[0][std::abs(around.x()) >= std::abs(around.y()) ? 1 : 0] = 0;
  }
  const SeamBasis basis(mesh, seams, translations);
  SeamlessMap map;
  const Eigen::VectorXd z =
      solveMap(mesh, seams, target, field.index, basis, "seamless", map.counters, progress);
  static_cast<Parametrization&>(map) = exactMap(mesh, basis, z, false);
  map.seams = seams;
  // A map in one chart can serve as the parameter plane of one trimmed surface, as long as it is one to one.
  // A tube that is not becomes a plane region, whose map cannot follow the field.
  if (overlaps(map, seams)) {
    map.counters.scaffolded = true;
    map.seams = withoutSeams(mesh, field);
    const SeamBasis plane(mesh, map.seams, {});
    const double follow = seams.rotation.empty() ? kFollow : 0.0;
    const Eigen::VectorXd apart = oneToOneMap(mesh, map.seams, target, plane, follow, map.counters, progress);
    static_cast<Parametrization&>(map) = exactMap(mesh, plane, apart, false);
  }
  map.target = target;
  map.index = field.index;
  return map;
}

}  // namespace trimquad
