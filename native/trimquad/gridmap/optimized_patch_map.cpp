#include "trimquad/gridmap/optimized_patch_map.h"

#include "trimquad/base/error.h"
#include "trimquad/gridmap/integer_charts.h"
#include "trimquad/seamless/newton.h"
#include "trimquad/seamless/solve_map.h"
#include "trimquad/seamless/untangle.h"
#include "trimquad/seamless/winding.h"

namespace trimquad {
namespace {

constexpr int kMostSteps = 300;
constexpr double kConverged =
    1e-3;  ///< relative decrease of the energy in a step, at which optimisation ends
constexpr double kRepair = 1.0 / 16;  ///< share of the budget of Newton steps for what doubles turn over

Eigen::VectorXd coordinatesOf(const IntegerCharts& charts, const SeamBasis& basis) {
  Eigen::VectorXd x(basis.basis().variableCount());
  for (std::size_t b = 0; b < charts.constraints.translations.size(); ++b)
    for (const int axis : {0, 1})
      x[basis.translation(int(b), axis)] = *charts.constraints.translations[b][axis];
  for (const auto h : charts.map.mesh.halfedges()) {
    if (charts.map.mesh.is_boundary(h)) continue;
    for (const int axis : {0, 1})
      x[basis.coordinate(basis.wedge(h), axis)] = charts.map.scale.toQuads(charts.map.from(h)[axis]);
  }
  for (const auto& place : charts.constraints.grid.places)
    for (const int axis : {0, 1})
      x[basis.gridPoint(place.point, axis)] = x[basis.coordinate(basis.wedge(place.corner), axis)];
  return x;
}

/// Whether z is locally injective in doubles, where need be after untangling: the patches' triangles can be
/// so thin that the exact map has them upright, but its doubles do not.
bool startsInjective(const IntegerCharts& charts, const SeamBasis& basis, const MapEnergy& energy,
                     Eigen::VectorXd& z, SparseSolver& solver, MapCounters& counters,
                     const Progress& progress) {
  counters.flippedBefore = energy.flipped(energy.coordinates(z));
  if (counters.flippedBefore == 0) return true;
  std::vector<int> index = coneQuarters(charts.map);
  for (int& i : index) i = 4 - i;
  const auto wrong = [&](const Eigen::VectorXd& map) {
    return wrongTriangles(charts.map.mesh, index, basis, energy, energy.coordinates(map));
  };
  StepBudget budget(kRepair);
  untangle(energy, wrong, z, counters, solver, budget, progress);
  const Eigen::VectorXd x = energy.coordinates(z);
  return energy.flipped(x) == 0 && wrongCones(charts.map.mesh, index, basis, x).empty();
}

}  // namespace

GridMap optimizedPatchMap(const SeamlessMap& seamless, const PatchMap& patches, const Progress& progress) {
  const IntegerCharts charts = integerCharts(seamless, patches);
  const SeamBasis basis(charts.map.mesh, charts.seams, charts.constraints);
  const MapEnergy energy(charts.map.mesh, charts.target, basis);
  Eigen::VectorXd z = basis.basis().restrict(coordinatesOf(charts, basis));
  GridMap result;
  SparseSolver solver("optimize");
  if (!startsInjective(charts, basis, energy, z, solver, result.counters, progress)) {
    // The map is one all the same, only with more distortion than it needs.
    static_cast<Parametrization&>(result) = charts.map;
    verify(result, true);
    return result;
  }
  result.counters.distortionStart = energy.meanSymmetricDirichlet(energy.coordinates(z));
  for (int i = 0; i < kMostSteps; ++i) {
    const double decrease = newtonStep(energy, straightDirichlet, seamless.follow, true, solver, z);
    ++result.counters.iterations;
    progress.report(double(i) / kMostSteps);
    if (decrease < kConverged) break;
  }
  result.counters.distortionEnd = energy.meanSymmetricDirichlet(energy.coordinates(z));
  static_cast<Parametrization&>(result) = exactMap(charts.map.mesh, basis, z, true);
  result.aligned = charts.map.aligned;
  result.featurePoints = charts.map.featurePoints;
  verify(result, true);
  return result;
}

}  // namespace trimquad
