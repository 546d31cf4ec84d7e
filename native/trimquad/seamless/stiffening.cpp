#include "trimquad/seamless/stiffening.h"

#include <limits>

#include "trimquad/seamless/solve_map.h"
#include "trimquad/seamless/untangle.h"
#include "trimquad/seamless/winding.h"

namespace trimquad {
namespace {

/// By face: whether it is within so many rings of triangles around the vertices.
std::vector<char> around(const SurfaceMesh& mesh, const std::vector<VertexHandle>& centres, int rings) {
  std::vector<char> near(mesh.n_vertices(), 0), inside(mesh.n_faces(), 0);
  for (const auto v : centres) near[v.idx()] = 1;
  for (int ring = 0; ring < rings; ++ring) {
    std::vector<char> next = near;
    for (const auto f : mesh.faces()) {
      bool touches = false;
      for (const auto v : mesh.fv_range(f)) touches = touches || near[v.idx()];
      if (!touches) continue;
      inside[f.idx()] = 1;
      for (const auto v : mesh.fv_range(f)) next[v.idx()] = 1;
    }
    near = std::move(next);
  }
  return inside;
}

}  // namespace

std::optional<Eigen::VectorXd> stiffenedMap(const SurfaceMesh& mesh, const MapStart& start,
                                            const std::vector<int>& index, const SeamBasis& basis,
                                            Eigen::VectorXd z, MapCounters& counters, StepBudget& budget,
                                            const Progress& progress) {
  constexpr int kRounds = 12, kPatience = 2, kRings = 2;
  constexpr double kFactor = 3;
  MapEnergy energy(mesh, *start.target, basis);
  energy.evenOut(start.evenness);
  SparseSolver solver("seamless");
  const auto wrongIn = [&](const Eigen::VectorXd& map) {
    return wrongTriangles(mesh, index, basis, energy, energy.coordinates(map));
  };
  size_t fewest = std::numeric_limits<size_t>::max();
  for (int round = 0, idle = 0; round < kRounds && idle < kPatience && !budget.spent(); ++round) {
    progress.check();
    const auto wrong = troubled(mesh, index, basis, energy, energy.coordinates(z));
    if (wrong.empty()) return z;
    idle = wrong.size() < fewest ? 0 : idle + 1;
    fewest = std::min(fewest, wrong.size());
    const auto inside = around(mesh, wrong, kRings);
    std::vector<double> factor(mesh.n_faces());
    for (size_t f = 0; f < factor.size(); ++f) factor[f] = inside[f] ? kFactor : 1;
    energy.stiffen(factor);
    z = leastSquares(energy, solver);
    ++counters.stiffenings;
    untangle(energy, wrongIn, z, counters, solver, budget, progress);
  }
  return std::nullopt;
}

}  // namespace trimquad
