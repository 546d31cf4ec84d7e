#include "trimquad/seamless/seed.h"

#include <algorithm>
#include <chrono>

#include "trimquad/base/error.h"
#include "trimquad/field/bridged_guidance.h"
#include "trimquad/field/curvature_guidance.h"
#include "trimquad/field/singularity_free_field.h"
#include "trimquad/seamless/local_refinement.h"

namespace trimquad {
namespace {

/// The mean symmetric Dirichlet energy up to which a map without singularities is worth more than one with
/// them; 4 is an isometry.
constexpr double kLittleDistortion = 4.3;

/// How far the guidance reaches at full weight; see crossField.
constexpr double kReach = 40;
/// What a field leaves of the work for the ones after it, at least.
constexpr double kForOthers = 0.5;
constexpr double kCurvatureWeight = 0.1, kGivenWeight = 1;
/// CrossField::follow at full weight of the guidance, at which directions are wanted rather than smoothness.
constexpr double kFollowGiven = 1;

double secondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

FieldGuidance guidanceFor(const Region& region, const SeedOptions& options, const Progress& progress) {
  switch (options.follow) {
    case SeedOptions::Follow::Given:
      TRIMQUAD_ASSERT(options.guidance.has_value());
      return overBridges(*options.guidance, region);
    case SeedOptions::Follow::Curvature:
      return curvatureGuidance(region, progress);
    case SeedOptions::Follow::Smooth:
      break;
  }
  return {std::vector<Eigen::Vector3d>(region.mesh.n_faces(), Eigen::Vector3d::UnitX()),
          std::vector<double>(region.mesh.n_faces(), 0.0)};
}

/// Runs `field`, then maps it; adds the seconds to `seed`. Returns the error where there is no map.
template <typename Field>
std::optional<Error> tryField(const Region& region, double edgeLength, const Field& field, Effort effort,
                              StepBudget& budget, const Progress& progress, Seed& seed) {
  auto start = std::chrono::steady_clock::now();
  std::optional<Error> failure;
  try {
    seed.field = field();
    seed.fieldSeconds += secondsSince(start);
    start = std::chrono::steady_clock::now();
    seed.map = seamlessMap(region, seed.field, edgeLength, effort, budget, progress);
    if (seed.map.refined) seed.field = refinedField(region.mesh, *seed.map.refined, seed.field);
  } catch (const Error& error) {
    if (error.kind() != Error::Kind::Stage) throw;
    failure = error;
  }
  seed.seamlessSeconds += secondsSince(start);
  return failure;
}

/// Counts what was spent as work in the end, whether there is a map or none.
struct CountedWork {
  const StepBudget& budget;
  const Progress& progress;
  ~CountedWork() { progress.addWork(budget.steps()); }
};

}  // namespace

Seed seed(const Region& region, const SeedOptions& options, const Progress& progress) {
  requireArea(region.mesh);
  Seed result;
  StepBudget budget;
  const CountedWork counted{budget, progress};
  const auto start = std::chrono::steady_clock::now();
  const FieldGuidance guidance = guidanceFor(region, options, progress);
  result.fieldSeconds = secondsSince(start);

  const bool given = options.follow == SeedOptions::Follow::Given;
  const double weight = options.weight.value_or(given ? kGivenWeight : kCurvatureWeight);
  std::vector<double> reaches{kReach * weight};
  while (reaches.back() > 1) reaches.push_back(reaches.back() / 4);
  if (options.follow != SeedOptions::Follow::Smooth && reaches.back() > 0) reaches.push_back(0);

  // Maps without singularities are worth some distortion, and are the last resort where all others fail.
  using Singularities = SeedOptions::Singularities;
  const bool mayDoWithout = options.singularities != Singularities::OfField &&
                            !(given && weight > kCurvatureWeight) && region.aligned.empty() &&
                            region.featurePoints.empty() && admitsNoSingularity(region.mesh);
  const auto withoutSingularities = [&] {
    return singularityFreeField(region.mesh, guidance, reaches.front(), progress);
  };
  std::optional<Seed> without;
  std::optional<Error> first;
  const auto tryWithout = [&](Effort effort) {
    if (!without && mayDoWithout) {
      const auto error =
          tryField(region, options.edgeLength, withoutSingularities, effort, budget, progress, result);
      if (!error)
        without = result;
      else if (options.singularities == Singularities::None)
        first = error;
    }
    return without && without->map.counters.distortionEnd <= kLittleDistortion;
  };
  if (options.singularities == Singularities::None) {
    tryWithout(Effort::Full);
    if (without) return *without;
    throw first.value_or(stageError("field", "the region has no map without singularities", region.name));
  }
  const bool prefersWithout = weight <= kCurvatureWeight;
  if (prefersWithout && tryWithout(Effort::Easy)) return *without;

  std::optional<Seed> with;
  for (const double reach : reaches) {
    const auto field = [&] {
      CrossField found = crossField(region, guidance, reach, progress);
      found.follow = std::max(found.follow, kFollowGiven * std::min(1.0, reach / kReach));
      return found;
    };
    const double aside = budget.setAside(reach == reaches.back() ? 0 : kForOthers);
    const auto error = tryField(region, options.edgeLength, field, Effort::Full, budget, progress, result);
    budget.add(aside);
    if (!error) {
      with = result;
      break;
    }
    if (!first) first = error;
    ++result.fieldEdits;
  }
  // Singularities that do not even make the map a better one are no use.
  const bool little = (prefersWithout || !with) && tryWithout(Effort::Full);
  if (with && !little &&
      (!without || with->map.counters.distortionEnd < without->map.counters.distortionEnd)) {
    with->fieldSeconds = result.fieldSeconds;
    with->seamlessSeconds = result.seamlessSeconds;
    return *with;
  }
  if (!without) throw *first;
  without->fieldEdits = result.fieldEdits;
  without->fieldSeconds = result.fieldSeconds;
  without->seamlessSeconds = result.seamlessSeconds;
  return *without;
}

}  // namespace trimquad
