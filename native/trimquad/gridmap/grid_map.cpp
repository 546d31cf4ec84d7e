#include "trimquad/gridmap/grid_map.h"

#include <algorithm>
#include <cmath>

#include "trimquad/base/error.h"
#include "trimquad/gridmap/grid_offset.h"
#include "trimquad/gridmap/node_relations.h"
#include "trimquad/seamless/solve_map.h"

namespace trimquad {
namespace {

/// Where the constructive route follows: multiply-adds for each triangle, which is less than what that route
/// takes.
constexpr double kBriefly = 4e4;

/// The images of the triangles: the map itself as a target.
MapTarget imageOf(const Parametrization& map) {
  MapTarget image(map.mesh.n_faces());
  for (const auto f : map.mesh.faces()) {
    auto h = map.mesh.halfedge_handle(f);
    for (int k = 0; k < 3; ++k, h = map.mesh.next_halfedge_handle(h))
      image[f.idx()][k] = map.scale.toQuads(map.from(h));
  }
  return image;
}

/// The seamless map in the coordinates of the basis, the grid points left at the origin.
Eigen::VectorXd seamlessCoordinates(const SeamlessMap& map, const SeamBasis& basis) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(basis.basis().variableCount());
  for (const auto h : map.mesh.halfedges()) {
    if (map.mesh.is_boundary(h)) continue;
    const Eigen::Vector2d corner = map.scale.toQuads(map.from(h));
    for (int axis = 0; axis < 2; ++axis) x[basis.coordinate(basis.wedge(h), axis)] = corner[axis];
    const auto& crossing = map.seams.crossing[h.idx()];
    if (!crossing || !crossing->forward) continue;
    const Eigen::Vector2d translation = map.scale.toQuads(map.transition(h).translation);
    for (int axis = 0; axis < 2; ++axis) x[basis.translation(crossing->branch, axis)] = translation[axis];
  }
  return x;
}

/// With fewer around a tube, its quads would share more than a side.
constexpr int kLeastAround = 3;

/// The translation of a tube's seam, rounded; the longer part of it is no less than `kLeastAround` quads.
BranchTranslation wholePeriod(const SeamlessMap& map) {
  for (const auto h : map.mesh.halfedges()) {
    const auto& crossing = map.seams.crossing[h.idx()];
    if (!crossing || !crossing->forward) continue;
    const Eigen::Vector2d period = map.scale.toQuads(map.transition(h).translation);
    const int axis = std::abs(period[0]) >= std::abs(period[1]) ? 0 : 1;
    BranchTranslation whole;
    whole[axis] =
        std::max(kLeastAround, int(std::lround(std::abs(period[axis])))) * (period[axis] < 0 ? -1 : 1);
    whole[1 - axis] = int(std::lround(period[1 - axis]));
    return whole;
  }
  TRIMQUAD_ASSERT(false);
  return {};
}

}  // namespace

GridMap gridMap(const SeamlessMap& seamless, const TMesh& tmesh, const Quantization& quantization,
                bool thorough, const Progress& progress) {
  GridMap map;
  const bool isFree = seamless.aligned.empty() && seamless.featurePoints.empty();
  if (seamless.seams.rotation.empty() && isFree) {
    // Nothing is bound to integers: the seamless map is a grid map, wherever it lies.
    map.counters = seamless.counters;
    static_cast<Parametrization&>(map) = seamless;
    const FixedVector offset = offsetOffBoundary(map);
    for (FixedVector& x : map.corner) x = x + offset;
    verify(map, true);
    return map;
  }
  // On a tube the period alone is. (Lengths of the T-mesh would move its holes' rims apart, each by itself.)
  const bool onlyPeriod = seamless.seams.tube && seamless.seams.rotation.front() == 0 && isFree;
  SeamConstraints constraints;
  if (onlyPeriod) {
    constraints.translations = {wholePeriod(seamless)};
  } else {
    constraints.aligned = seamless.alignedSides;
    constraints.grid = gridPoints(seamless.mesh, seamless.seams, tmesh, quantization);
  }
  const SeamBasis basis(seamless.mesh, seamless.seams, constraints);
  const MapTarget image = imageOf(seamless);
  const MapProblem problem{seamless.mesh,   seamless.seams,
                           seamless.target, startsOf({&image, &seamless.target, &seamless.conformalTarget}),
                           seamless.index,  seamless.follow,
                           basis,           "optimize"};
  const StepBudget budget =
      thorough ? StepBudget() : StepBudget::ofWork(kBriefly * double(seamless.mesh.n_faces()));
  const Eigen::VectorXd z =
      solveMap(problem, seamlessCoordinates(seamless, basis), budget, map.counters, progress);
  static_cast<Parametrization&>(map) = exactMap(seamless.mesh, basis, z, true);
  map.aligned = seamless.aligned;
  map.featurePoints = seamless.featurePoints;
  verify(map, true);
  return map;
}

}  // namespace trimquad
