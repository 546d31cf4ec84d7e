#include "trimquad/spline/fit_bulges.h"

#include <algorithm>
#include <set>

namespace trimquad {
namespace {

/// Which part of its knot rectangle a bulge stands for in the fit, how many times more when it comes again;
/// part of the rectangle up to which another one is the same.
constexpr double kPart = 0.125, kAgain = 4, kSame = 0.25;
/// Part of a bulge's height from which on one is looked for around; steps of that, by the knot intervals, and
/// how often they are halved.
constexpr double kNearBulge = 0.75, kClimb = 0.1;
constexpr int kClimbHalvings = 3;

}  // namespace

std::optional<Bulge> bulgeNear(const FittedRegion& region, const SplineSurface& surface,
                               const Eigen::Vector2d& at, const Eigen::Vector2d& knotIntervals,
                               const std::function<bool(const Eigen::Vector2d&)>& isInChart) {
  const auto farther = [&](const Eigen::Vector2d& x, double than) {
    return region.farther(surface.jet(surface.wrappedU(x[0]), x[1]), than);
  };
  const double limit = region.limit();
  auto highest = farther(at, kNearBulge * limit);
  if (!highest) return {};
  Eigen::Vector2d top = at, step = kClimb * knotIntervals;
  for (int halvings = 0; highest->distance <= limit && halvings <= kClimbHalvings;) {
    bool rises = false;
    for (const int axis : {0, 1})
      for (const double way : {1, -1}) {
        Eigen::Vector2d there = top;
        there[axis] += way * step[axis];
        if (!isInChart(there)) continue;
        const auto found = farther(there, highest->distance);
        if (!found) continue;
        highest = found;
        top = there;
        rises = true;
        break;
      }
    if (rises) continue;
    step /= 2;
    ++halvings;
  }
  if (highest->distance <= limit) return {};
  return highest;
}

bool BulgeSpots::note(const std::vector<FitPlace>& bulges,
                      const std::function<Eigen::Vector2d(const FitPlace&)>& knotIntervals) {
  std::set<std::size_t> again;
  const std::size_t before = spots_.size();
  for (const auto& x : bulges) {
    const auto known = std::find_if(spots_.begin(), spots_.end(), [&](const Spot& spot) {
      return spot.at.chart == x.chart &&
             ((x.parameter - spot.at.parameter).cwiseAbs().array() <= kSame * spot.reach.array()).all();
    });
    if (const auto k = std::size_t(known - spots_.begin()); known == spots_.end()) {
      const Eigen::Vector2d reach = knotIntervals(x);
      spots_.push_back({x, reach, kPart * reach.prod()});
    } else if (k < before) {
      again.insert(k);
    }
  }
  for (const std::size_t k : again) spots_[k].weight *= kAgain;
  return !bulges.empty();
}

void BulgeSpots::appendTo(std::vector<std::vector<Datum>>& data,
                          const std::function<Eigen::Vector3d(const FitPlace&)>& target) const {
  for (const auto& spot : spots_)
    data[spot.at.chart].push_back({spot.at.parameter, target(spot.at), spot.weight});
}

}  // namespace trimquad
