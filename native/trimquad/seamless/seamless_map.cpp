#include "trimquad/seamless/seamless_map.h"

#include <algorithm>
#include <cmath>

#include "trimquad/base/error.h"
#include "trimquad/mesh/boundary_image.h"
#include "trimquad/seamless/conformal_scale.h"
#include "trimquad/seamless/local_refinement.h"
#include "trimquad/seamless/newton.h"
#include "trimquad/seamless/solve_map.h"
#include "trimquad/seamless/winding.h"

namespace trimquad {
namespace {

/// How much more a map may be distorted so that it covers no part of the plane twice.
constexpr double kWorthOneSurface = 2;

MapTarget mapTarget(const SurfaceMesh& mesh, const CrossField& field, const std::vector<int>& combing,
                    double edgeLength) {
  MapTarget target(mesh.n_faces());
  for (const auto f : mesh.faces()) {
    HalfedgeHandle h = mesh.halfedge_handle(f);
    std::array<Eigen::Vector3d, 3> p;
    for (int k = 0; k < 3; ++k, h = mesh.next_halfedge_handle(h))
      p[k] = mesh.point(mesh.from_vertex_handle(h));
    const Eigen::Vector3d normal = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
    Eigen::Vector3d u = field.direction[f.idx()];
    for (int turn = 0; turn < combing[f.idx()]; ++turn) u = normal.cross(u);
    const Eigen::Vector3d v = normal.cross(u);
    for (int k = 0; k < 3; ++k)
      target[f.idx()][k] = Eigen::Vector2d((p[k] - p[0]).dot(u), (p[k] - p[0]).dot(v)) / edgeLength;
  }
  return target;
}

/// The target's image of a side of a triangle, from its start to its end.
Eigen::Vector2d alongSide(const SurfaceMesh& mesh, const MapTarget& target, HalfedgeHandle side) {
  const auto f = mesh.face_handle(side);
  int k = 0;
  for (auto h = mesh.halfedge_handle(f); h != side; h = mesh.next_halfedge_handle(h)) ++k;
  return target[f.idx()][(k + 1) % 3] - target[f.idx()][k];
}

/// The sides of triangles along aligned edges, with the coordinate that the target keeps constant there.
std::vector<AlignedSide> alignedSides(const SurfaceMesh& mesh, const std::vector<EdgeHandle>& aligned,
                                      const MapTarget& target) {
  std::vector<AlignedSide> sides;
  for (const auto e : aligned)
    for (int k = 0; k < 2; ++k) {
      const auto side = mesh.halfedge_handle(e, k);
      if (mesh.is_boundary(side)) continue;
      const Eigen::Vector2d d = alongSide(mesh, target, side);
      sides.push_back({side, std::abs(d.x()) < std::abs(d.y()) ? 0 : 1});
    }
  return sides;
}

/// How far, in quads, one end of a tube runs along the field's two directions on its way around.
Eigen::Vector2d lengthAlongEnd(const SurfaceMesh& mesh, const CrossField& field, const MapTarget& target) {
  const auto loops = boundaryLoops(mesh);
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  const auto end = std::find(field.loopTurns.begin(), field.loopTurns.end(), 0) - field.loopTurns.begin();
  for (const auto boundary : loops[size_t(end)]) {
    sum += alongSide(mesh, target, mesh.opposite_halfedge_handle(boundary));
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

/// The loop that is to go around the others where a region is mapped as one plane chart: the field's outer
/// loop, or the longer end of its tube.
int outerLoopOf(const SurfaceMesh& mesh, const CrossField& field) {
  const auto loops = boundaryLoops(mesh);
  int outer = -1;
  double longest = -1;
  for (int l = 0; l < int(loops.size()); ++l) {
    double length = 0;
    for (const auto h : loops[l]) length += mesh.calc_edge_length(h);
    if (field.loopTurns[l] < 0 || length <= longest) continue;
    longest = length;
    outer = l;
  }
  TRIMQUAD_ASSERT(outer >= 0);
  return outer;
}

/// A map that is still to be found, of a mesh with a field and seams: all but the map itself.
struct Draft {
  SurfaceMesh mesh;
  CrossField field;
  SeamlessMap map;

  Draft(const SurfaceMesh& itsMesh, CrossField itsField, SeamGraph seams, double edgeLength)
      : mesh(itsMesh), field(std::move(itsField)) {
    map.seams = std::move(seams);
    map.target = mapTarget(mesh, field, map.seams.combing, edgeLength);
    map.conformalTarget = map.target;
    const auto scale = conformalScale(mesh, field);
    for (size_t f = 0; f < scale.size(); ++f)
      for (auto& corner : map.conformalTarget[f]) corner *= scale[f];
    map.alignedSides = alignedSides(mesh, field.aligned, map.target);
    map.index = field.index;
    map.follow = field.follow;
    map.aligned = field.aligned;
  }

  SeamBasis basis() const {
    SeamConstraints constraints;
    constraints.aligned = map.alignedSides;
    if (map.seams.tube) {
      // A tube's period lies along one axis: the one that its ends follow more. An oblique one would make the
      // grid wind around the tube like a thread.
      const Eigen::Vector2d around = lengthAlongEnd(mesh, field, map.target);
      constraints.translations.resize(1);
      constraints.translations[0][std::abs(around.x()) >= std::abs(around.y()) ? 1 : 0] = 0;
    }
    return {mesh, map.seams, constraints};
  }

  /// Whether a convex embedding can serve as a start: it never fails, so that fewer others are worth while.
  bool hasConvexStart() const { return (map.seams.outerLoop || map.seams.tube) && field.aligned.empty(); }

  MapProblem problem(const SeamBasis& basis) const {
    auto starts = startsOf({&map.target, &map.conformalTarget});
    if (hasConvexStart()) starts.resize(2);
    return {mesh, map.seams, map.target, std::move(starts), map.index, map.follow, basis, "seamless"};
  }
};

/// The triangles that the best of the maps leaves wrong.
std::vector<FaceHandle> fewestWrong(const Draft& draft, const SeamBasis& basis, const UntangledMaps& maps) {
  const MapEnergy energy(draft.mesh, draft.map.target, basis);
  std::vector<FaceHandle> fewest;
  for (size_t k = 0; k < maps.reached.size(); ++k) {
    auto wrong =
        wrongTriangles(draft.mesh, draft.map.index, basis, energy, energy.coordinates(maps.reached[k]));
    if (k == 0 || wrong.size() < fewest.size()) fewest = std::move(wrong);
  }
  return fewest;
}

/// Where untangling leaves triangles wrong around a few places: the draft with the edges there halved, again
/// and again, and what untangling comes to then; nothing where that does not help. The field stays the same.
std::optional<std::pair<Draft, Eigen::VectorXd>> locallyRefined(const Region& region, const Draft& whole,
                                                                std::vector<FaceHandle> wrong,
                                                                double edgeLength, MapCounters& counters,
                                                                StepBudget& budget,
                                                                const Progress& progress) {
  constexpr int kRounds = 3;
  constexpr double kFew = 0.02;  // of the triangles: more is not the mesh's fault
  constexpr size_t kAlwaysFew = 20;
  RefinedMesh refined = unrefined(region.mesh);
  const int flippedBefore = counters.flippedBefore;
  for (int round = 0; round < kRounds && !budget.spent(); ++round) {
    if (double(wrong.size()) > std::max(double(kAlwaysFew), kFew * double(refined.mesh.n_faces())))
      return std::nullopt;
    for (const auto e : edgesOf(refined.mesh, within(refined.mesh, wrong, 1))) {
      splitInMiddle(region.mesh, refined, e);
      ++counters.halvedEdges;
    }
    ++counters.refinements;
    const CrossField field = refinedField(region.mesh, refined, whole.field);
    Draft draft(refined.mesh, field, seamGraph(refined.mesh, field), edgeLength);
    const SeamBasis basis = draft.basis();
    const auto maps =
        untangledMaps(draft.problem(basis), std::nullopt, Effort::Full, counters, budget, progress);
    counters.flippedBefore = flippedBefore;
    if (maps.injective) {
      draft.map.refined = std::move(refined);
      return std::pair(std::move(draft), *maps.injective);
    }
    wrong = fewestWrong(draft, basis, maps);
  }
  return std::nullopt;
}

/// A map in one chart can serve as the parameter plane of one trimmed surface, as long as it is one to one.
/// A tube that is not becomes a plane region, whose map cannot follow the field.
void keepOneToOne(const Draft& draft, SeamlessMap& map, const Progress& progress) {
  const auto& [mesh, field, unused] = draft;
  if ((!map.seams.outerLoop && !map.seams.tube) || !field.aligned.empty() || !overlaps(map, map.seams))
    return;
  const double follow = map.seams.tube ? 0.0 : map.follow;
  SeamlessMap grown = map;
  grown.counters.scaffolded = true;
  grown.seams = withoutSeams(mesh, field, outerLoopOf(mesh, field));
  const SeamBasis plane(mesh, grown.seams, {});
  const Eigen::VectorXd apart =
      oneToOneMap(mesh, grown.seams, grown.target, plane, follow, grown.counters, progress);
  // Beyond that several surfaces serve better.
  if (grown.counters.distortionEnd > kWorthOneSurface * map.counters.distortionEnd) return;
  static_cast<Parametrization&>(grown) = exactMap(mesh, plane, apart, false);
  map = std::move(grown);
}

}  // namespace

SeamlessMap seamlessMap(const Region& region, const CrossField& field, double edgeLength, Effort effort,
                        StepBudget& budget, const Progress& progress) {
  if (!(edgeLength > 0) || !std::isfinite(edgeLength))
    throw inputError("seamless", "the edge length must be a positive number");
  Draft draft(region.mesh, field, seamGraph(region.mesh, field), edgeLength);
  const SeamBasis basis = draft.basis();
  MapCounters counters;
  const auto maps = untangledMaps(draft.problem(basis), std::nullopt, effort, counters, budget, progress);
  std::optional<Eigen::VectorXd> z = maps.injective;
  if (!z && effort == Effort::Full && !draft.hasConvexStart())
    if (auto found = locallyRefined(region, draft, fewestWrong(draft, basis, maps), edgeLength, counters,
                                    budget, progress)) {
      draft = std::move(found->first);
      z = std::move(found->second);
    }
  if (!z) z = stubbornMap(draft.problem(basis), maps, effort, counters, budget, progress);
  const SeamBasis finalBasis = draft.basis();
  optimize(draft.problem(finalBasis), *z, counters, progress);
  SeamlessMap map = draft.map;
  map.counters = counters;
  static_cast<Parametrization&>(map) = exactMap(draft.mesh, finalBasis, *z, false);
  keepOneToOne(draft, map, progress);
  map.aligned = draft.field.aligned;
  map.featurePoints = region.featurePoints;
  verify(map, false);
  return map;
}

}  // namespace trimquad
