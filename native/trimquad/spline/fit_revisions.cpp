#include "trimquad/spline/fit_rounds.h"

/// Revisions of a fit that is there: of some of its charts, which start from the samples' feet and the knots
/// of the fit.

namespace trimquad {
namespace {

/// Rounds of parameter correction on halved knots.
constexpr int kMaxCorrectionsHalved = 4;

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
