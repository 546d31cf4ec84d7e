#include "trimquad/spline/fit_bulges.h"

#include <algorithm>
#include <set>

namespace trimquad {
namespace {

/// Which part of its knot rectangle a bulge stands for in the fit, how many times more when it comes again;
/// part of the rectangle up to which another one is the same.
constexpr double kPart = 0.125, kAgain = 4, kSame = 0.25;

}  // namespace

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
