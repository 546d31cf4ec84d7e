#include "trimquad/spline/fit_rounds.h"

/// Revisions of a fit that is there, which start from its samples' feet: over fewer knots, or of some of its
/// charts.

namespace trimquad {
namespace {

/// Rounds of parameter correction on halved knots.
constexpr int kMaxCorrectionsHalved = 4;
/// Part of the tolerance that respaced knots are to keep, by the surface's bending, with at most this part of
/// the poles; the same by the residual on respaced knots; part of the poles that are to go for a fit to be
/// worth it; part of the knots that stay at least from one such fit to the next; such fits, and rounds of
/// parameter correction on each.
constexpr double kSpacedFor = 0.5, kSpacedPoles = 0.55, kSpacingReserve = 0.9, kWorthSpacing = 0.95,
                 kLeastSpacing = 0.75;
constexpr int kMaxSpacings = 6, kMaxSpacedCorrections = 4;

}  // namespace

void FitRounds::continueFrom(const FittedSurface& fitted) {
  const auto& from = *fitted.continuation;
  result_ = fitted;
  fairness_ = from.fairness;
  joinedKnots()->charts = from.sampledOver;
  takeSamples();
  *joinedKnots() = from.knots;  // samples change the tangents at singularities
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    samples_[i].chart = from.samples[i].chart;
    samples_[i].parameter = from.samples[i].parameter;
    emphasis_[i] = from.samples[i].emphasis;
  }
  measureFit();
}

std::optional<FittedSurface> FitRounds::smoothed(const FittedSurface& fitted,
                                                 const std::map<int, int>& steps) {
  continueFrom(fitted);
  std::vector<const SplineSpace*> spaces;
  for (int c = 0; c < charts(); ++c) spaces.push_back(&space(c));
  std::vector<int> chosen;
  for (const auto& [chart, count] : steps) chosen.push_back(chart);
  std::optional<FittedSurface> smooth;
  for (RectangleStiffness stiffness(spaces, steps); stiffness.update(samples_, tolerance_);) {
    fairness_.stiffness = stiffness.factors();
    auto surfaces = partOfLeastSquares(dataOf(samples_, emphasis_), chosen, result_.surfaces);
    if (!surfaces) break;
    result_.surfaces = std::move(*surfaces);
    measureFit();
    if (deviation_.max <= enough_ && verified(enough_, kSmallFolds) && result_.bulges <= fitted.bulges)
      smooth = result_;
  }
  if (smooth) smooth->continuation = fitted.continuation;
  return smooth;
}

std::optional<FittedSurface> FitRounds::closer(const FittedSurface& fitted, const std::vector<int>& chosen) {
  continueFrom(fitted);
  halveKnots(chosen);
  const double before = deviation_.rms;
  std::optional<FittedSurface> result;
  for (corrections_ = 0; corrections_ <= kMaxCorrectionsHalved; correct()) {
    auto surfaces = partOfLeastSquares(dataOf(samples_, emphasis_), chosen, result_.surfaces);
    if (!surfaces) break;
    result_.surfaces = std::move(*surfaces);
    measureFit();
    if (deviation_.max <= enough_ && deviation_.rms < before && verified(enough_, kSmallFolds) &&
        result_.bulges <= fitted.bulges)
      result = result_;
  }
  return result;
}

/// The surfaces, which are within the tolerance, or such over fewer knots. Knots are halved where they do not
/// do, which leaves up to twice as many in every direction as there need be.
FittedSurface FitRounds::economised() {
  kept_ = result_;
  int fewest = poles();
  bool has = respaceByBending(kSpacedFor * tolerance_, kSpacedPoles);
  for (int attempt = 0; attempt < kMaxSpacings && has && poles() < kWorthSpacing * fewest; ++attempt) {
    if (fitsRespaced()) {
      kept_ = result_;
      fewest = poles();
      has = respaceByResidual(kSpacingReserve * tolerance_, kLeastSpacing);
    } else {
      has = respaceByResidual(kSpacingReserve * tolerance_, 1);
    }
  }
  return std::move(*kept_);
}

/// Whether surfaces over knots that were respaced keep the tolerance, from the feet on those before.
bool FitRounds::fitsRespaced() {
  takeSamples();
  measure(samples_, feet_);
  moveTo(feet_, samples_);
  solve();
  for (corrections_ = 0; deviation_.max > tolerance_; solve()) {
    const bool close = deviation_.max <= kClose * tolerance_;
    if (corrections_ > 0 &&
        (!close || corrections_ >= kMaxSpacedCorrections || deviation_.max > kCorrectionPays * previous_.max))
      return false;
    correct();
  }
  return deviation_.turnedOver.empty() && verified(tolerance_, 0) && result_.bulges == 0 &&
         result_.folded.empty();
}

std::shared_ptr<const FittedSurface::Continuation> FitRounds::continuation() {
  const JoinedKnots* knots = joinedKnots();
  if (!knots) return {};
  auto result = std::make_shared<FittedSurface::Continuation>();
  result->knots = *knots;
  result->fairness = fairness_;
  result->sampledOver = sampledOver_;
  for (std::size_t i = 0; i < samples_.size(); ++i)
    result->samples.push_back({samples_[i].chart, samples_[i].parameter, emphasis_[i]});
  return result;
}

}  // namespace trimquad
