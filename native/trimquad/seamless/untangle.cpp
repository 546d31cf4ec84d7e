#include "trimquad/seamless/untangle.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "trimquad/seamless/neighbourhoods.h"
#include "trimquad/seamless/newton.h"

namespace trimquad {
namespace {

double workOfStep(const MapEnergy& energy, const SparseSolver& solver) {
  constexpr double kDense = 0.25;  // a multiplication in dense blocks takes so much of the others' time
  return energy.stepWork() + kDense * solver.work();
}

/// Moves triangles that have only just been turned back away from collapse: a single one would keep all steps
/// of later optimisation short.
void relax(const MapEnergy& energy, SparseSolver& solver, Eigen::VectorXd& z, StepBudget& budget) {
  constexpr int kSteps = 20;
  constexpr double kRelaxed = 1e-2;  // relative decrease of the energy in a step
  for (int step = 0; step < kSteps; ++step) {
    const double decrease = newtonStep(energy, symmetricDirichlet, 0, true, solver, z);
    budget.spend(workOfStep(energy, solver));
    if (decrease < kRelaxed) break;
  }
}

/// A part of a map without flipped triangles. Where none is flipped it is wrong in another way: like where
/// triangles get stuck, only another start helps then.
std::optional<Eigen::VectorXd> untangledPart(const MapEnergy& part, Eigen::VectorXd z, StepBudget& budget,
                                             const Progress& progress) {
  SparseSolver solver("seamless");
  int iterations = 0;
  const auto flipped = [&] { return part.flipped(part.coordinates(z)) > 0; };
  bool turnedBack = false;
  if (flipped()) {
    untangleWhole(part, z, iterations, solver, budget, progress);
    turnedBack = !flipped();
  }
  if (!turnedBack) {
    newtonStep(part, noDistortion, 1, false, solver, z);  // to the Poisson map
    untangleWhole(part, z, iterations, solver, budget, progress);
    if (flipped()) return std::nullopt;
  }
  relax(part, solver, z, budget);
  return z;
}

}  // namespace

void untangle(const MapEnergy& energy, const WrongTriangles& wrong, Eigen::VectorXd& z, MapCounters& counters,
              SparseSolver& solver, StepBudget& budget, const Progress& progress) {
  constexpr double kNeighbourhoods = 8;  // steps on the whole: what they are worth trying
  const Eigen::VectorXd start = z;
  const auto byNeighbourhoods = [&] {
    const double aside = budget.setAsideAllBut(kNeighbourhoods * workOfStep(energy, solver));
    untangleNeighbourhoods(energy, wrong, z, counters.neighbourhoods, budget, progress);
    budget.add(aside);
  };
  byNeighbourhoods();
  if (wrong(z).empty()) return;
  z = start;
  untangleWhole(energy, z, counters.untangleIterations, solver, budget, progress);
  byNeighbourhoods();
}

void untangleWhole(const MapEnergy& energy, Eigen::VectorXd& z, int& iterations, SparseSolver& solver,
                   StepBudget& budget, const Progress& progress) {
  double least = energy.smallestDeterminant(energy.coordinates(z));
  if (least > 0) return;
  // Where it works, every few rounds halve the depth of the deepest fold, or turn triangles back, or leave
  // less area turned over. Energies go on falling for hundreds of steps where it does not. The first round
  // spreads deep folds over many triangles: what it leaves is what the others have to be better than.
  constexpr int kRounds = 40, kStepsPerRound = 8, kPatience = 4;
  // Similarities have the least energy at det = (1 + sqrt(4 - 12 epsilon^2)) / 3: at 2 / 3 for this one, at 0
  // for more than 1 / sqrt(3): then a single deep fold would make the whole map collapse.
  constexpr double kMostEpsilon = 0.5;
  int fewest = std::numeric_limits<int>::max();
  double shallowest = least, smallest = std::numeric_limits<double>::infinity();
  for (int round = 0, idle = 0; round < kRounds && idle < kPatience; ++round) {
    const double depth = std::min(0.0, least),
                 epsilon = std::min(kMostEpsilon, std::sqrt(1e-12 + 0.04 * depth * depth));
    const auto density = [&](double I, double D) { return foldoverFree(I, D, epsilon); };
    const double roundStart = least;
    for (int step = 0; step < kStepsPerRound; ++step) {
      progress.check();
      if (budget.spent()) return;
      const double decrease = newtonStep(energy, density, 0, false, solver, z);
      ++iterations;
      budget.spend(workOfStep(energy, solver));
      least = energy.smallestDeterminant(energy.coordinates(z));
      if (least > 0) return;
      if (least > roundStart / 2 || decrease < 1e-5) break;
    }
    const Eigen::VectorXd x = energy.coordinates(z);
    const int flipped = energy.flipped(x);
    const double turned = energy.value(x, turnedArea, 0);
    idle = least > shallowest / 2 || flipped < fewest || turned < smallest / 2 ? 0 : idle + 1;
    fewest = std::min(fewest, flipped);
    shallowest = std::max(shallowest, least);
    smallest = std::min(smallest, turned);
  }
}

void untangleNeighbourhoods(const MapEnergy& energy, const WrongTriangles& wrong, Eigen::VectorXd& z,
                            int& kept, StepBudget& budget, const Progress& progress) {
  constexpr int kFewestRings = 2, kMostRings = 16;
  constexpr double kLargest = 0.5;  // of the triangles: for more it is not worth while to hold the others
  if (budget.spent()) return;
  auto triangles = wrong(z);
  if (triangles.empty()) return;
  const Neighbourhoods neighbourhoods(energy);
  for (int rings = kFewestRings; rings <= kMostRings && !triangles.empty() && !budget.spent(); rings *= 2) {
    auto parts = neighbourhoods.around(triangles, rings);
    std::stable_sort(parts.begin(), parts.end(),
                     [](const auto& a, const auto& b) { return a.faces.size() < b.faces.size(); });
    for (const auto& [faces, unknowns] : parts) {
      if (double(faces.size()) > kLargest * energy.faceCount() || budget.spent()) break;
      const MapEnergy part = energy.restricted(faces, unknowns, z);
      if (const auto mine = untangledPart(part, z(unknowns), budget, progress)) {
        z(unknowns) = *mine;
        ++kept;
      }
    }
    triangles = wrong(z);
  }
}

}  // namespace trimquad
