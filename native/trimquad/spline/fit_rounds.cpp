#include "trimquad/spline/fit_rounds.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "trimquad/base/parallel.h"
#include "trimquad/spline/fit_control.h"
#include "trimquad/spline/parameter_smoothing.h"

namespace trimquad {
namespace {

/// Rounds of parameter correction on the same knots; the same where the deviation is close, and the part of
/// it that one has to leave at most there for another to be worth it: the last bit is cheaper than more
/// knots.
constexpr int kMaxCorrections = 4, kMaxCorrectionsClose = 12;
constexpr double kCorrectionPaysClose = 0.96;
/// Multiple of the tolerance below which parameters are corrected, unless knots alone do not help: feet on a
/// surface that is still far from the region would bring its waves into the parameters.
constexpr double kCorrectionStarts = 20;
/// Part of the deviation with the chart's parameters that the one with corrected parameters must stay under
/// to be kept; where the tolerance is close, and starting again from the chart's would only lose what was
/// won.
constexpr double kCorrectedWins = 0.7;
constexpr double kCorrectedWinsClose = 0.95;
/// How much more the samples that deviate most weigh in the next round, to even out the largest deviations.
constexpr double kEmphasis = 10;
/// Where samples slide, little is left but what the knots allow, and weights that grow with the deviation
/// from round to round even it out (Lawson); what they grow by at most, and in all.
constexpr double kSlidingEmphasis = 3, kMostEmphasis = 20;
/// The same of samples next to where the surface is turned over, which keep the map's parameters: these fold
/// nowhere.
constexpr double kFoldEmphasis = 20;
/// Only where the deviation is above this part of the largest one are knots inserted: it reaches a few spans
/// beyond its cause, where it goes away by itself. Along a crease it does not, and all that fail are refined.
constexpr double kWorstPart = 0.3;
/// Refinements in a row that may bring less than a fifth.
constexpr int kPatience = 4;
/// The same of several surfaces that stay farther away than so many tolerances: a crease that runs across
/// charts, or noise, which knots without end would follow.
constexpr int kPatienceFar = 1;
constexpr double kFar = 5;
/// With so few poles that says nothing yet: a sharp bend keeps its deviation until knots are as narrow as it.
constexpr int kFewPoles = 1000;
constexpr int kPatienceWithFew = 10;
/// Multiples of the poles of the closest surfaces so far, and of the closest that are turned over nowhere, at
/// which a fit that came no closer since is given up; the latter where there are too many folds to be taken:
/// more knots fold it more.
constexpr double kVainPoles = 3, kVainCleanPoles = 4;
/// Several surfaces with so many poles are to be within so many tolerances: what asks for that many is noise,
/// or creases across charts, and the rest of the way takes many times as long.
constexpr int kManyPoles = 60000;
constexpr double kNearWithMany = 1.5;
/// Part of the samples at which the surface may be turned over while parameters are still corrected.
constexpr double kFewTurned = 0.05;
/// Rounds that are spent on getting rid of folds within what is enough.
constexpr int kFoldPatience = 8;
/// Rounds that are spent on getting rid of bulges between samples.
constexpr int kBulgePatience = 10;
/// Part of the way to an opposite sheet that a surface should not be farther away than, and how many times
/// closer than elsewhere it is to stay for that at most.
constexpr double kOwnPart = 0.4, kMostCloser = 4;
/// Area whose weight a corner that is held carries in addition, quads^2.
constexpr double kCornerArea = 0.3;

std::string shortNumber(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", x);
  return text;
}

}  // namespace

FitRounds::FitRounds(const Region& region, const FitOptions& options, const Policy& policy,
                     const Progress& progress)
    : region_(region),
      tolerance_(options.tolerance),
      enough_(std::max(options.tolerance, options.enough)),
      threads_(options.threads),
      maxPoles_(std::min(policy.maxPoles, options.maxPoles)),
      maxWork_(std::min(options.maxWork, std::numeric_limits<long>::max() - progress.work()) +
               progress.work()),
      progress_(progress),
      fitted_(region, tolerance_, enough_),
      policy_(policy),
      holdsCorners_(options.holdsCorners),
      foldSpots_(policy.folds),
      slides_(options.slides && !policy.several) {}

void FitRounds::setScale(double surfaceArea, double mapArea, double extent) {
  const double quad = std::sqrt(surfaceArea / mapArea);
  toleranceInQuads_ = tolerance_ / quad;
  // With the energy as an integral over the same plane as the squared distance, the deviation that it costs
  // is below 3 % of the tolerance times the surface's bending per quad.
  fairness_.withData = std::max(1e-3 * toleranceInQuads_ * toleranceInQuads_, 1e-13);
  fairness_.withoutData = std::max(1e3 * fairness_.withData, 1e-9);
  narrowest_ = std::exp2(std::floor(std::log2(extent / 16)));
}

FittedSurface FitRounds::run() try { return rounds(); } catch (const Error& error) {
  if (!kept_ || error.kind() != Error::Kind::Stage) throw;
  return std::move(*kept_);
}

FittedSurface FitRounds::rounds() {
  takeSamples();
  for (rounds_ = 1; rounds_ <= policy_.maxRounds; ++rounds_) {
    if (!solved_) solve();
    solved_ = newBulges_ = false;
    if (slides_ && corrections_ > 0 && !deviation_.turnedOver.empty()) stopSliding();
    if (rounds_ == 1) start_ = best_ = deviation_.max;
    best_ = std::min(best_, deviation_.max);
    closest_.note(deviation_.max, poles());
    if (deviation_.turnedOver.empty()) closestClean_.note(deviation_.max, poles());
    if (best_ > tolerance_) progress_.report(std::log(start_ / best_) / std::log(start_ / tolerance_));
    if (deviation_.max <= tolerance_ && deviation_.turnedOver.empty() && verified(tolerance_, 0) &&
        result_.bulges == 0 && result_.folded.empty())
      return economised();
    keepIfEnough();
    const bool hasBulges = kept_ && kept_->bulges > 0;
    if (hasBulges && ++bulgeRounds_ > kBulgePatience) throw unreachable();
    if (smoothsFolds() && !hasBulges && ++foldRounds_ > kFoldPatience) throw unreachable();
    stiffenFolds();
    if (newBulges_ || correctionPays()) {
      correct();
    } else {
      if (policy_.takesBack && corrections_ > 0 && deviation_.max > beforeCorrection_.deviation.max)
        restore(std::move(beforeCorrection_));
      if (refine())
        chooseParameters();
      else
        correct();
    }
  }
  throw unreachable();
}

void FitRounds::takeSamples() {
  samples_ = makeSamples(false);
  if (const JoinedKnots* knots = joinedKnots()) sampledOver_ = knots->charts;
  keepSheetsApart();
  if (holdsCorners_) holdCorners();
  ofMap_.clear();
  for (const auto& s : samples_) ofMap_.push_back({s.chart, s.parameter});
  cells_ = cells();
  emphasis_.assign(samples_.size(), 1);
}

/// Two sheets within the tolerance of their region pass through each other where that is thinner than twice
/// as much: samples weigh more there.
void FitRounds::keepSheetsApart() {
  parallelParts(int(samples_.size()), threads_, [&](int begin, int end) {
    progress_.check();
    for (int i = begin; i < end; ++i) {
      auto& s = samples_[i];
      const auto opposite = fitted_.triangles().closestFacing(s.point, -s.meshNormal, tolerance_ / kOwnPart);
      if (!opposite) continue;
      const double closer = tolerance_ / (kOwnPart * std::sqrt(opposite->squaredDistance));
      s.weight *= std::pow(std::clamp(closer, 1.0, kMostCloser), 2);
    }
  });
}

/// The samples begin with the region's vertices.
void FitRounds::holdCorners() {
  for (std::size_t v = 0; v < region_.corner.size(); ++v)
    if (region_.corner[v]) samples_[v].weight += kCornerArea;
}

std::vector<std::vector<Datum>> FitRounds::dataOf(const std::vector<SurfaceSample>& samples,
                                                  const std::vector<double>& emphasis) const {
  std::vector<std::vector<Datum>> data(charts());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto& s = samples[i];
    data[s.chart].push_back({s.parameter, s.point, s.weight * emphasis[i], s.free});
  }
  return data;
}

/// The surfaces through the samples at their parameters, and their deviation.
void FitRounds::solve() {
  auto data = dataOf(samples_, emphasis_);
  bulgeSpots_.appendTo(data, [&](const FitPlace& x) {
    return fitted_.closest(result_.surfaces[x.chart].point(x.parameter[0], x.parameter[1]));
  });
  auto surfaces = leastSquares(data);
  for (int attempt = 0; !surfaces && attempt < 4; ++attempt) {
    stiffen(100);
    surfaces = leastSquares(data);
  }
  if (!surfaces)
    throw stageError("fit",
                     std::string("the normal equations of the ") +
                         (policy_.several ? "surfaces" : "surface") + " are singular",
                     region_.name);
  result_.surfaces = std::move(*surfaces);
  previous_ = deviation_;
  measureFit();
  failing_ = places(samples_, threshold(deviation_.max));
  noteTurned(samples_, deviation_);
}

/// Sets each sample's distance. Gives the feet as well: each one's place, or the sample's own where the foot
/// lies more than a knot interval away, on the other side or where a crease ends the way to it.
Deviation FitRounds::measure(std::vector<SurfaceSample>& samples, std::vector<FitPlace>& feet) const {
  progress_.addWork(long(samples.size()));
  feet.resize(samples.size());
  std::vector<char> turnedOver(samples.size(), 0);
  parallelParts(int(samples.size()), threads_, [&](int begin, int end) {
    progress_.check();
    for (int i = begin; i < end; ++i) {
      auto& s = samples[i];
      const FitPlace from{s.chart, s.parameter};
      const auto [at, start, limited] = foot(s.point, from);
      const auto& surface = result_.surfaces[at.chart];
      const auto jet = surface.jet(at.parameter[0], at.parameter[1]);
      const Eigen::Vector3d normal = jet.su.cross(jet.sv), d = s.point - jet.s;
      s.distance = d.dot(normal) < 0 ? -d.norm() : d.norm();
      Eigen::Vector2d move = (at.parameter - start.parameter).cwiseAbs();
      if (surface.closedU) move[0] = std::min(move[0], surface.lastU() - surface.firstU() - move[0]);
      const SplineLine &u = space(at.chart).u, &v = space(at.chart).v;
      const bool near = !limited && move[0] <= u.width(u.spanOf(at.parameter[0])) &&
                        move[1] <= v.width(v.spanOf(at.parameter[1]));
      turnedOver[i] = !s.agrees(normal) && !fitted_.facesLikewise(jet.s, normal);
      if (!near || turnedOver[i] || isHeld(s)) {
        feet[i] = from;
        continue;
      }
      feet[i] = at;
      feet[i].free.setIdentity() -= normal * normal.transpose() / normal.squaredNorm();
    }
  });
  return deviationOf(samples, turnedOver);
}

/// Of the samples that lie farther away than that.
std::vector<FitPlace> FitRounds::places(const std::vector<SurfaceSample>& samples, double above) {
  std::vector<FitPlace> result;
  for (const auto& s : samples)
    if (!(std::abs(s.distance) <= above)) result.push_back({s.chart, s.parameter});
  return result;
}

std::vector<FitPlace> FitRounds::places(const std::vector<SurfaceSample>& samples,
                                        const std::vector<int>& chosen) {
  std::vector<FitPlace> result;
  for (const int i : chosen) result.push_back({samples[i].chart, samples[i].parameter});
  return result;
}

void FitRounds::noteTurned(const std::vector<SurfaceSample>& samples, const Deviation& deviation) {
  turned_ = places(samples, deviation.turnedOver);
  if (!turned_.empty()) turnedPoint_ = samples[deviation.turnedOver[0]].point;
}

void FitRounds::moveTo(const std::vector<FitPlace>& places, std::vector<SurfaceSample>& samples) const {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i].chart = places[i].chart;
    samples[i].parameter = places[i].parameter;
    if (slides_)
      samples[i].free = places[i].free;
    else
      samples[i].free.setZero();
  }
}

/// Moves the parameters to the feet.
void FitRounds::correct() {
  ++corrections_;
  if (policy_.takesBack || slides_) beforeCorrection_ = state();
  moveTo(feet_, samples_);
  if (policy_.several) smoothParameters();
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const double part = samples_[i].distance / deviation_.max;
    emphasis_[i] = slides_ ? std::min(kMostEmphasis, emphasis_[i] * (1 + kSlidingEmphasis * part * part))
                           : 0.5 * (emphasis_[i] + 1 + kEmphasis * part * part);
  }
  unfold(deviation_.turnedOver, between_);
}

/// How far feet are from the map's parameters, averaged over about a knot interval: what is left then bends
/// no more closely than the knots can, which fold otherwise. Samples across a border and on creases keep
/// their feet.
void FitRounds::smoothParameters() {
  std::vector<Eigen::Vector2d> moves(samples_.size(), Eigen::Vector2d::Zero());
  std::vector<std::optional<int>> chart(samples_.size());
  std::vector<char> held(samples_.size(), 1);
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const FitPlace &map = ofMap_[i], foot{samples_[i].chart, samples_[i].parameter};
    const auto seen = seenFrom(map.chart, foot);
    if (!seen) continue;
    chart[i] = map.chart;
    held[i] = foot.chart != map.chart || isOnCrease(map);
    moves[i] = *seen - map.parameter;
  }
  smoothMoves(cells_, chart, held, moves);
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const FitPlace x{ofMap_[i].chart, ofMap_[i].parameter + moves[i]};
    if (!held[i] && isInChart(x)) samples_[i].parameter = x.parameter;
  }
}

/// Back to before the correction that turned the surface over somewhere; from here on all of the distances
/// count.
void FitRounds::stopSliding() {
  slides_ = false;
  restore(std::move(beforeCorrection_));
  for (auto& s : samples_) s.free.setZero();
  emphasis_.assign(samples_.size(), 1);
}

/// Around samples where the surface is turned over, or beside which it is: back to the map's parameters.
void FitRounds::unfold(std::vector<int> turnedOver, const BetweenFeet& between) {
  for (const int k : between.turnedOverCells)
    turnedOver.insert(turnedOver.end(), cells_[k].begin(), cells_[k].end());
  for (const auto& cell : cellsAround(cells_, turnedOver))
    for (const int i : cell) returnToMap(i);
}

void FitRounds::returnToMap(int sample) {
  auto& s = samples_[sample];
  s.chart = ofMap_[sample].chart;
  s.parameter = ofMap_[sample].parameter;
  s.free.setZero();
  emphasis_[sample] = kFoldEmphasis;
}

/// On new knots: the map's parameters, which are smooth where the map is, or those corrected on the coarser
/// knots, which carry a trace of these but are free of a rough map's noise; whichever bring the surfaces
/// closer.
void FitRounds::chooseParameters() {
  const bool corrected = corrections_ > 0;
  corrections_ = 0;
  takeSamples();
  if (!corrected) return;
  const Deviation found = measure(samples_, feet_);
  const BetweenFeet between = lookBetweenFeet(found, false);
  moveTo(feet_, samples_);
  if (policy_.several) smoothParameters();
  const auto emphasis = emphasis_;
  unfold(found.turnedOver, between);
  solve();
  State withFeet = state();
  emphasis_ = emphasis;
  moveTo(ofMap_, samples_);
  solve();
  const Deviation& corrections = withFeet.deviation;
  const double folds = double(std::max(corrections.turnedOver.size(), deviation_.turnedOver.size()));
  const bool foldsLess = corrections.turnedOver.size() <= deviation_.turnedOver.size() ||
                         (!deviation_.turnedOver.empty() && folds <= kSmallFolds * double(samples_.size()));
  const double wins = corrections.max <= kClose * tolerance_ ? kCorrectedWinsClose : kCorrectedWins;
  if (foldsLess && corrections.max < wins * deviation_.max) restore(std::move(withFeet));
  solved_ = true;
}

/// Keeps the surfaces for the case that none come closer, or none without folds.
void FitRounds::keepIfEnough() {
  const std::size_t folds = deviation_.turnedOver.size();
  if (deviation_.max > enough_ || double(folds) > kSmallFolds * double(samples_.size())) return;
  if (kept_ && kept_->bulges == 0 &&
      (folds > 0 ? folds >= kept_->folded.size()
                 : kept_->folded.empty() && deviation_.max > 0.95 * kept_->maxDeviation))
    return;
  if (folds > 0 && !stayNear(result_.surfaces, samples_, cellsAround(cells_, deviation_.turnedOver),
                             fitted_.triangles(), enough_))
    return;
  const auto failing = failing_;
  const auto turned = turned_;
  const bool isEnough = verified(enough_, kSmallFolds);
  const bool better =
      !kept_ || (result_.bulges > 0 || kept_->bulges > 0
                     ? result_.maxDeviation < kept_->maxDeviation
                     : result_.folded.empty() || result_.folded.size() < kept_->folded.size());
  if (isEnough && better) kept_ = result_;
  failing_ = failing;
  turned_ = turned;
}

/// Whether other samples keep the tolerance as well; counts bulges between them too. \param folds part of
/// them that may be turned over
bool FitRounds::verified(double tolerance, double folds) {
  auto control = makeSamples(true);
  std::vector<FitPlace> feet;
  Deviation found = measure(control, feet);
  if (startNearby(control, samples_, tolerance, threads_, progress_)) found = measure(control, feet);
  result_.deviations = deviationsByChart(int(result_.surfaces.size()), {control, feet}, {samples_, feet_});
  if (policy_.failsAtFeet) moveTo(feet, control);
  result_.bulges = 0;
  result_.maxDeviation = std::max(found.max, deviation_.max);
  result_.rmsDeviation = found.rms;
  result_.rounds = rounds_;
  result_.folded.clear();
  folds_.clear();
  for (const int i : found.turnedOver) {
    result_.folded.push_back({control[i].point, feet[i].chart});
    folds_.push_back(feet[i]);
  }
  for (const int i : deviation_.turnedOver) result_.folded.push_back({samples_[i].point, feet_[i].chart});
  result_.samples = int(control.size() + samples_.size());
  if (found.max > tolerance || double(found.turnedOver.size()) > folds * double(control.size())) {
    failing_ = places(control, threshold(found.max));
    noteTurned(control, found);
    return false;
  }
  between_ = lookBetweenFeet(deviation_, true);
  result_.bulges = int(between_.away.size());
  newBulges_ =
      bulgeSpots_.note(between_.away, [&](const FitPlace& x) { return knotIntervals(x); }) || newBulges_;
  for (const auto& x : between_.away) {
    const auto bulge = bulgeAt(x);
    if (!bulge) continue;
    auto& chart = result_.deviations[x.chart];
    if (bulge->distance > chart.max) {
      chart.max = bulge->distance;
      chart.where = bulge->point;
    }
    result_.maxDeviation = std::max(result_.maxDeviation, bulge->distance);
  }
  for (const auto& x : between_.turnedOver) {
    result_.folded.push_back({result_.surfaces[x.chart].point(x.parameter[0], x.parameter[1]), x.chart});
    folds_.push_back(x);
  }
  if (!between_.away.empty() || !between_.turnedOver.empty()) {
    failing_ = between_.away;
    turned_ = between_.turnedOver;
    if (!turned_.empty()) turnedPoint_ = result_.folded.back().point;
  }
  result_.continuation = continuation();
  return true;
}

std::optional<Bulge> FitRounds::bulgeAt(const FitPlace& x) const {
  const auto isInside = [&](const Eigen::Vector2d& at) { return isInChart({x.chart, at}); };
  return bulgeNear(fitted_, result_.surfaces[x.chart], x.parameter, knotIntervals(x), isInside);
}

/// What the surfaces are between the feet, where they come close.
BetweenFeet FitRounds::lookBetweenFeet(const Deviation& deviation, bool forBulges) const {
  if (deviation.max > kClose * tolerance_) return {};
  FitView view{[&](int chart, const FitPlace& x) { return seenFrom(chart, x); },
               [&](const FitPlace& x) { return isInChart(x); },
               [&](const FitPlace& x) { return knotInterval(x); },
               [&](const Eigen::Vector3d& p, const Eigen::Vector3d& normal) {
                 return fitted_.facesLikewise(p, normal);
               },
               {}};
  if (forBulges) view.isAway = [&](const FitPlace& x) { return bulgeAt(x).has_value(); };
  BetweenFeet result = betweenFeet(result_.surfaces, samples_, feet_, cells_, view, threads_, progress_);
  if (forBulges)
    for (const FitPlace& x : borderPlaces())
      if (bulgeAt(x)) result.away.push_back(x);
  return result;
}

void FitRounds::measureFit() {
  deviation_ = measure(samples_, feet_);
  between_ = lookBetweenFeet(deviation_, false);
}

Eigen::Vector2d FitRounds::knotIntervals(const FitPlace& x) const {
  const SplineLine &u = space(x.chart).u, &v = space(x.chart).v;
  return {u.width(u.spanOf(x.parameter[0])), v.width(v.spanOf(x.parameter[1]))};
}

/// Deviation above which a sample asks for knots.
double FitRounds::threshold(double largest) const {
  return thorough_ ? tolerance_ : std::max(tolerance_, kWorstPart * largest);
}

bool FitRounds::correctionPays() const {
  const bool early = deviation_.max > kCorrectionStarts * tolerance_ && !stalled();
  if (double(deviation_.turnedOver.size()) > kFewTurned * double(samples_.size())) return false;
  const bool close = deviation_.max <= kClose * tolerance_;
  if (deviation_.max <= tolerance_ || early ||
      corrections_ >= (close ? kMaxCorrectionsClose : kMaxCorrections))
    return false;
  const double pays = close ? kCorrectionPaysClose : kCorrectionPays;
  return corrections_ == 0 || deviation_.max <= pays * previous_.max ||
         deviation_.rms <= kCorrectionPays * previous_.rms;
}

/// More knots, or else more fairness. Whether there are others now.
bool FitRounds::refine() {
  if (progress_.work() > maxWork_) throw unreachable();
  if (failing_.empty()) {
    // Within tolerance, but turned over somewhere.
    if (insertKnots()) return true;
    if (smoothsFolds()) return false;
    if (++stiffened_ > 3)
      throw stageError("fit", "the surface folds over; use a smaller edge length, or cut the region there",
                       region_.name, turnedPoint_);
    stiffen(30);
    return true;
  }
  idle_ = best_ < 0.8 * atRefinement_ ? 0 : idle_ + 1;
  thorough_ = stalled();
  atRefinement_ = best_;
  if (idle_ > 0) giveWay();
  const bool far = policy_.several && best_ > kFar * tolerance_ && poles() > kFewPoles;
  const bool hopeless = policy_.several && poles() > kManyPoles && best_ > kNearWithMany * tolerance_;
  const bool manyFolds = double(deviation_.turnedOver.size()) > kSmallFolds * double(samples_.size());
  const bool vain =
      poles() > kFewPoles && (poles() > kVainPoles * closest_.poles ||
                              (manyFolds && poles() > kVainCleanPoles * double(closestClean_.poles)));
  const int patience = far ? kPatienceFar : poles() > kFewPoles ? kPatience : kPatienceWithFew;
  if (hopeless || vain || idle_ > patience || !insertKnots() || poles() > maxPoles_) throw unreachable();
  return true;
}

/// More fairness where the surfaces are turned over in few places.
void FitRounds::stiffenFolds() {
  if (deviation_.max <= kClose * tolerance_ &&
      double(deviation_.turnedOver.size()) <= kSmallFolds * double(samples_.size())) {
    for (const int i : deviation_.turnedOver) folds_.push_back(feet_[i]);
    folds_.insert(folds_.end(), between_.turnedOver.begin(), between_.turnedOver.end());
  }
  foldSpots_.update(folds_, failing_, [&](const FitPlace& x) { return knotInterval(x); });
  fairness_.spots = foldSpots_.spots();
  folds_.clear();
}

void FitRounds::stiffen(double factor) {
  fairness_.withData *= factor;
  fairness_.withoutData *= factor;
}

FitRounds::State FitRounds::state() const {
  return {samples_, feet_, failing_, result_.surfaces, deviation_, between_};
}

void FitRounds::restore(State state) {
  samples_ = std::move(state.samples);
  feet_ = std::move(state.feet);
  failing_ = std::move(state.failing);
  result_.surfaces = std::move(state.surfaces);
  deviation_ = state.deviation;
  between_ = std::move(state.between);
}

int FitRounds::poles() const {
  int sum = 0;
  for (int c = 0; c < charts(); ++c) sum += space(c).poles();
  return sum;
}

Error FitRounds::unreachable() const {
  const auto& where = samples_[std::max(0, deviation_.worst)].point;
  const std::string count = std::to_string(poles());
  if (best_ <= tolerance_)
    return stageError("fit",
                      "the surface folds over wherever it keeps the tolerance " + shortNumber(tolerance_) +
                          " (" + count + " poles); use a smaller edge length, or cut the region there",
                      region_.name, where);
  return stageError("fit",
                    "the tolerance " + shortNumber(tolerance_) + " cannot be met, the " +
                        (policy_.several ? "surfaces come" : "surface comes") + " within " +
                        shortNumber(best_) + " with " + count +
                        " poles; allow a larger tolerance or use a smaller edge length",
                    region_.name, where);
}

}  // namespace trimquad
