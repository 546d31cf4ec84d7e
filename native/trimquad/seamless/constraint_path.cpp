#include "trimquad/seamless/constraint_path.h"

#include "trimquad/seamless/newton.h"
#include "trimquad/seamless/solve_map.h"
#include "trimquad/seamless/untangle.h"
#include "trimquad/seamless/winding.h"

namespace trimquad {
namespace {

MapTarget imageOf(const SurfaceMesh& mesh, const SeamBasis& basis, const Eigen::VectorXd& x) {
  MapTarget image(mesh.n_faces());
  for (const auto f : mesh.faces()) {
    auto h = mesh.halfedge_handle(f);
    for (int k = 0; k < 3; ++k, h = mesh.next_halfedge_handle(h))
      for (int axis = 0; axis < 2; ++axis)
        image[f.idx()][k][axis] = x[basis.coordinate(basis.wedge(h), axis)];
  }
  return image;
}

}  // namespace

std::optional<Eigen::VectorXd> followConstraints(const SurfaceMesh& mesh, MapEnergy energy,
                                                 const std::vector<int>& index, const SeamBasis& basis,
                                                 double follow, const Eigen::VectorXd& x,
                                                 MapCounters& counters, SparseSolver& solver,
                                                 StepBudget& budget, const Progress& progress) {
  MapEnergy ahead = energy;
  Eigen::VectorXd z = basis.basis().restrict(x);
  // What the constants of x are beyond those of the basis; goes to 0.
  Eigen::VectorXd rest = x - energy.coordinates(z);
  energy.shift(rest);
  constexpr double kShortest = 1.0 / 64;
  double left = 1;
  for (double step = 0.5; step >= kShortest && !budget.spent();) {
    ahead.aim(imageOf(mesh, basis, energy.coordinates(z)));
    const double length = std::min(step, left);
    const Eigen::VectorXd shift = (left - length) * rest;
    ahead.shift(shift);
    Eigen::VectorXd next = leastSquares(ahead, solver);
    const auto wrong = [&](const Eigen::VectorXd& map) {
      return wrongTriangles(mesh, index, basis, ahead, ahead.coordinates(map));
    };
    untangle(ahead, wrong, next, counters, solver, budget, progress);
    ++counters.pathSteps;
    if (!wrong(next).empty()) {
      step = length / 2;
      continue;
    }
    z = next;
    left -= length;
    energy.shift(shift);
    if (left == 0) return z;
    constexpr int kRelax = 3;
    for (int relax = 0; relax < kRelax; ++relax)
      newtonStep(energy, symmetricDirichlet, follow, true, solver, z);
    step = 2 * length;
  }
  return std::nullopt;
}

}  // namespace trimquad
