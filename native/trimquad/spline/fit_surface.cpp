#include "trimquad/spline/fit_surface.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "trimquad/base/error.h"
#include "trimquad/base/parallel.h"
#include "trimquad/spline/deviation.h"
#include "trimquad/spline/fit_layout.h"
#include "trimquad/spline/knot_refinement.h"
#include "trimquad/spline/spline_space.h"
#include "trimquad/spline/surface_samples.h"

namespace trimquad {
namespace {

constexpr int kMaxRounds = 100;
constexpr int kMaxPoles = 100000;
/// Rounds of parameter correction on the same knots, and the part of the deviation that one has to leave at
/// most for another to be worth it.
constexpr int kMaxCorrections = 4;
constexpr double kCorrectionPays = 0.85;
/// Multiple of the tolerance below which parameters are corrected, unless knots alone do not help: feet on a
/// surface that is still far from the region would bring its waves into the parameters.
constexpr double kCorrectionStarts = 20;
/// Part of the deviation with the chart's parameters that the one with corrected parameters must stay under
/// to be kept.
constexpr double kCorrectedWins = 0.7;
/// How much more the samples that deviate most weigh in the next round, to even out the largest deviations.
constexpr double kEmphasis = 10;
/// Only where the deviation is above this part of the largest one are knots inserted: it reaches a few spans
/// beyond its cause, where it goes away by itself. Along a crease it does not, and all that fail are refined.
constexpr double kWorstPart = 0.3;
/// Refinements in a row that may bring less than a fifth.
constexpr int kPatience = 4;

/// u of the line at which a closed chart is cut: a whole quad, where the line crosses the region in the
/// fewest pieces; the middle of the longest row of such lines, for the fit moves the boundary a little.
Quanta seamOf(const GridMap& map, const Chart& chart) {
  const Quanta one = chart.scale.one(), period = *chart.period;
  const int lines = int(period / one);
  std::vector<int> crossings(lines + 1, 0);
  const auto floorDivide = [](Quanta a, Quanta b) { return a / b - (a % b < 0); };
  std::vector<int> count(lines, 0);
  for (const auto h : map.mesh.halfedges()) {
    if (!map.mesh.is_boundary(h)) continue;
    const HalfedgeHandle inner = map.mesh.opposite_halfedge_handle(h);
    const Quanta a = chart.corner[inner.idx()].u,
                 b = chart.corner[map.mesh.next_halfedge_handle(inner).idx()].u;
    for (Quanta line = floorDivide(std::min(a, b), one) + 1; line * one <= std::max(a, b); ++line)
      ++count[((line % lines) + lines) % lines];
  }
  const int fewest = *std::min_element(count.begin(), count.end());
  int best = 0, bestRun = 0;
  for (int start = 0; start < lines; ++start) {
    int run = 0;
    while (run < lines && count[(start + run) % lines] == fewest) ++run;
    if (run <= bestRun) continue;
    bestRun = run;
    best = run == lines ? 0 : (start + run / 2) % lines;
  }
  return best * one;
}

SplineLine initialLine(int degree, double first, double last, double span, bool closed) {
  SplineLine line{degree, closed, {}};
  const double length = last - first;
  int spans = std::max(1, int(std::lround(length / span)));
  if (closed) spans = std::max(spans, degree + 1);
  while (closed && spans > length && spans & (spans - 1))
    ++spans;  // under one quad a power of two, to be exact
  for (int i = 0; i <= spans; ++i) {
    const double at = length * i / spans;
    line.breaks.push_back(first + (spans <= length ? std::round(at) : at));
  }
  return line;
}

/// The coarsest space: two spans along the longer side of the domain, four around a tube.
SplineSpace initialSpace(const GridMap& map, const Chart& chart, double seam, int degree) {
  Quanta low[2], high[2];
  bool first = true;
  for (const auto h : map.mesh.halfedges()) {
    if (map.mesh.is_boundary(h)) continue;
    const FixedVector x = chart.corner[h.idx()];
    for (int axis = 0; axis < 2; ++axis) {
      low[axis] = first ? x[axis] : std::min(low[axis], x[axis]);
      high[axis] = first ? x[axis] : std::max(high[axis], x[axis]);
    }
    first = false;
  }
  const auto& scale = chart.scale;
  const double lengthU = scale.toQuads(high[0] - low[0]), lengthV = scale.toQuads(high[1] - low[1]);
  // Trim curves are intersections with neighbours and leave the region's image a little.
  const double room = std::max(0.5, 0.01 * std::max(lengthU, lengthV));
  double u0 = std::floor(scale.toQuads(low[0]) - room), u1 = std::ceil(scale.toQuads(high[0]) + room);
  const double v0 = std::floor(scale.toQuads(low[1]) - room), v1 = std::ceil(scale.toQuads(high[1]) + room);
  if (chart.period) {
    u0 = seam;
    u1 = seam + scale.toQuads(*chart.period);
  }
  const double span = chart.period ? (u1 - u0) / 4 : std::max(u1 - u0, v1 - v0) / 2;
  return {initialLine(degree, u0, u1, span, chart.period.has_value()),
          initialLine(degree, v0, v1, span, false)};
}

/// Sets each sample's distance. Gives the feet as well: each one's parameter, or the sample's own where the
/// foot lies more than a knot interval away or on the other side.
Deviation measure(const SplineSurface& surface, const SplineSpace& space, std::vector<SurfaceSample>& samples,
                  std::vector<Eigen::Vector2d>& feet, int threads, const Progress& progress) {
  feet.resize(samples.size());
  std::vector<char> turnedOver(samples.size(), 0);
  parallelParts(int(samples.size()), threads, [&](int begin, int end) {
    progress.check();
    for (int i = begin; i < end; ++i) {
      auto& s = samples[i];
      const Eigen::Vector2d foot = surface.footPoint(s.point, s.parameter, kFootStep);
      const auto jet = surface.jet(foot[0], foot[1]);
      const Eigen::Vector3d normal = jet.su.cross(jet.sv), d = s.point - jet.s;
      s.distance = d.dot(normal) < 0 ? -d.norm() : d.norm();
      Eigen::Vector2d move = (foot - s.parameter).cwiseAbs();
      if (surface.closedU) move[0] = std::min(move[0], surface.lastU() - surface.firstU() - move[0]);
      const bool near = move[0] <= space.u.width(space.u.spanOf(foot[0])) &&
                        move[1] <= space.v.width(space.v.spanOf(foot[1]));
      turnedOver[i] = !s.agrees(normal);
      feet[i] = near && !turnedOver[i] ? foot : s.parameter;
    }
  });
  return deviationOf(samples, turnedOver);
}

std::vector<Eigen::Vector2d> failing(const std::vector<SurfaceSample>& samples, double tolerance) {
  std::vector<Eigen::Vector2d> result;
  for (const auto& s : samples)
    if (!(std::abs(s.distance) <= tolerance)) result.push_back(s.parameter);
  return result;
}

std::string shortNumber(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", x);
  return text;
}

Error unreachable(const Region& region, double tolerance, double reached, int poles,
                  const Eigen::Vector3d& where) {
  if (reached <= tolerance)
    return stageError("fit",
                      "the surface folds over wherever it keeps the tolerance " + shortNumber(tolerance) +
                          " (" + std::to_string(poles) +
                          " poles); use a smaller edge length, or cut the region there",
                      region.name, where);
  return stageError("fit",
                    "the tolerance " + shortNumber(tolerance) + " cannot be met, the surface comes within " +
                        shortNumber(reached) + " with " + std::to_string(poles) +
                        " poles; allow a larger tolerance or use a smaller edge length",
                    region.name, where);
}

/// The fit's state between rounds.
class Fit {
 public:
  Fit(const Region& region, const GridMap& map, const FitOptions& options, const Chart& chart, double seam,
      const Progress& progress)
      : region_(region),
        tolerance_(options.tolerance),
        enough_(std::max(options.tolerance, options.enough)),
        threads_(options.threads),
        progress_(progress),
        space_(initialSpace(map, chart, seam, options.degree)),
        source_(region, map, chart, seam, progress) {
    const double quad = std::sqrt(surfaceArea(map.mesh) / source_.chartArea());
    const double inQuads = tolerance_ / quad;
    // With the energy as an integral over the same plane as the squared distance, the deviation that it costs
    // is below 3 % of the tolerance times the surface's bending per quad.
    fairness_.withData = std::max(1e-3 * inQuads * inQuads, 1e-13);
    fairness_.withoutData = std::max(1e3 * fairness_.withData, 1e-9);
    narrowest_ = std::exp2(std::floor(std::log2(source_.triangleExtent() / 16)));
  }

  /// Runs rounds until the tolerance holds.
  FittedSurface run() try { return rounds(); } catch (const Error& error) {
    if (!kept_ || error.kind() != Error::Kind::Stage) throw;
    return std::move(*kept_);
  }

 private:
  FittedSurface rounds() {
    makeSamples();
    for (rounds_ = 1; rounds_ <= kMaxRounds; ++rounds_) {
      if (!solved_) solve();
      solved_ = false;
      if (rounds_ == 1) start_ = best_ = deviation_.max;
      best_ = std::min(best_, deviation_.max);
      if (best_ > tolerance_) progress_.report(std::log(start_ / best_) / std::log(start_ / tolerance_));
      if (deviation_.max <= tolerance_ && deviation_.turnedOver == 0 && verified(tolerance_))
        return std::move(result_);
      keepIfEnough();
      if (correctionPays()) {
        correct();
      } else {
        refine();
        chooseParameters();
      }
    }
    throw unreachable(region_, tolerance_, best_, space_.poles(), position());
  }

 private:
  /// The surface through the samples at their parameters, and its deviation.
  void solve() {
    std::vector<Datum> data;
    data.reserve(samples_.size());
    for (size_t i = 0; i < samples_.size(); ++i) {
      const auto& s = samples_[i];
      data.push_back({s.parameter, s.point, s.weight * emphasis_[i]});
    }
    auto surface = space_.leastSquares(data, fairness_, progress_);
    for (int attempt = 0; !surface && attempt < 4; ++attempt) {
      stiffen(100);
      surface = space_.leastSquares(data, fairness_, progress_);
    }
    if (!surface) throw stageError("fit", "the normal equations of the surface are singular", region_.name);
    result_.surface = std::move(*surface);
    previous_ = deviation_;
    deviation_ = measure(result_.surface, space_, samples_, feet_, threads_, progress_);
    failing_ = failing(samples_, threshold(deviation_.max));
  }

  /// Moves the parameters to the feet.
  void correct() {
    ++corrections_;
    for (size_t i = 0; i < feet_.size(); ++i) {
      auto& s = samples_[i];
      s.parameter = feet_[i];
      const double part = s.distance / deviation_.max;
      emphasis_[i] = 0.5 * (emphasis_[i] + 1 + kEmphasis * part * part);
    }
  }

  void makeSamples() {
    samples_ = source_.make(space_, false, progress_);
    cells_ = source_.cells();
    emphasis_.assign(samples_.size(), 1);
  }

  /// On new knots: the chart's parameters, which are smooth where the map is, or those corrected on the
  /// coarser knots, which carry a trace of these but are free of a rough map's noise; whichever bring the
  /// surface closer.
  void chooseParameters() {
    const bool corrected = corrections_ > 0;
    corrections_ = 0;
    makeSamples();
    if (!corrected) return;
    std::vector<Eigen::Vector2d> ofChart;
    for (const auto& s : samples_) ofChart.push_back(s.parameter);
    const auto useParameters = [&](const std::vector<Eigen::Vector2d>& parameters) {
      for (size_t i = 0; i < samples_.size(); ++i) samples_[i].parameter = parameters[i];
    };
    measure(result_.surface, space_, samples_, feet_, threads_, progress_);
    useParameters(feet_);
    const auto feet = feet_;
    solve();
    const Deviation withFeet = deviation_;
    useParameters(ofChart);
    solve();
    const bool keepFeet = withFeet.turnedOver == 0 && withFeet.max < kCorrectedWins * deviation_.max;
    if (keepFeet) useParameters(feet);
    solved_ = !keepFeet;
  }

  /// Keeps the surface for the case that none comes closer.
  void keepIfEnough() {
    if (deviation_.max > enough_ || deviation_.turnedOver > 0) return;
    if (kept_ && deviation_.max > 0.95 * kept_->maxDeviation) return;
    const auto failing = failing_;
    if (verified(enough_)) kept_ = result_;
    failing_ = failing;
  }

  bool verified(double tolerance) {
    auto control = source_.make(space_, true, progress_);
    std::vector<Eigen::Vector2d> feet;
    const Deviation found = measure(result_.surface, space_, control, feet, threads_, progress_);
    for (size_t i = 0; i < control.size(); ++i) control[i].parameter = feet[i];
    result_.maxDeviation = std::max(found.max, deviation_.max);
    result_.rmsDeviation = found.rms;
    result_.rounds = rounds_;
    if (found.max <= tolerance && found.turnedOver == 0) return true;
    failing_ = failing(control, threshold(found.max));
    deviation_.turnedOver = found.turnedOver;
    return false;
  }

  /// Deviation above which a sample asks for knots.
  double threshold(double largest) const {
    return thorough_ ? tolerance_ : std::max(tolerance_, kWorstPart * largest);
  }

  /// Whether the last refinement has not even halved the deviation.
  bool stalled() const { return best_ > 0.5 * atRefinement_; }

  bool correctionPays() {
    const bool early = deviation_.max > kCorrectionStarts * tolerance_ && !stalled();
    if (deviation_.turnedOver > kFewTurned * double(samples_.size())) return false;
    if (deviation_.max <= tolerance_ || early || corrections_ >= kMaxCorrections) return false;
    if (corrections_ > 0 && deviation_.max > kCorrectionPays * previous_.max &&
        deviation_.rms > kCorrectionPays * previous_.rms)
      return false;
    return true;
  }

  void refine() {
    if (failing_.empty()) {
      // Within tolerance, but turned over somewhere.
      if (++stiffened_ > 3)
        throw stageError("fit", "the surface folds over; use a smaller edge length, or cut the region there",
                         region_.name, samples_[std::max(0, deviation_.firstTurned)].point);
      stiffen(30);
      return;
    }
    idle_ = best_ < 0.8 * atRefinement_ ? 0 : idle_ + 1;
    thorough_ = stalled();
    atRefinement_ = best_;
    if (idle_ > kPatience || !refineKnots(space_, samples_, cells_, failing_, narrowest_) ||
        space_.poles() > kMaxPoles)
      throw unreachable(region_, tolerance_, best_, int(result_.surface.poles.size()), position());
  }

  void stiffen(double factor) {
    fairness_.withData *= factor;
    fairness_.withoutData *= factor;
  }

  Eigen::Vector3d position() const { return samples_[std::max(0, deviation_.worst)].point; }

  const Region& region_;
  double tolerance_;
  double enough_;
  int threads_;
  const Progress& progress_;
  SplineSpace space_;
  SurfaceSamples source_;
  std::vector<SurfaceSample> samples_;
  std::vector<std::array<int, 3>> cells_;
  Fairness fairness_;
  double narrowest_ = 0;
  FittedSurface result_;
  std::optional<FittedSurface> kept_;  ///< within what is enough
  Deviation deviation_, previous_;
  std::vector<Eigen::Vector2d> failing_, feet_;
  std::vector<double> emphasis_;  ///< by sample: factor of its weight
  double start_ = 0, best_ = 0, atRefinement_ = std::numeric_limits<double>::infinity();
  bool solved_ = false;    ///< the surface and its deviation belong to the present knots and parameters
  bool thorough_ = false;  ///< the worst places alone did not bring the deviation down
  int rounds_ = 0, corrections_ = 0, stiffened_ = 0, idle_ = 0;
};

}  // namespace

FittedSurface fitSurface(const Region& region, const GridMap& map, const FitOptions& options,
                         const Progress& progress) {
  if (!(options.tolerance > 0) || !std::isfinite(options.tolerance))
    throw inputError("fit", "the tolerance must be a positive number");
  if (options.degree < 2 || options.degree > 5) throw inputError("fit", "the degree must be 2, 3, 4 or 5");
  auto single = singleChart(map);
  if (!single || std::any_of(map.aligned.begin(), map.aligned.end(),
                             [&](EdgeHandle e) { return !map.mesh.is_boundary(e); }))
    return fitLayout(region, map, layout(map, progress), options, progress);
  Chart unrolled = std::move(*single);
  const double seam = unrolled.period ? unrolled.scale.toQuads(seamOf(map, unrolled)) : 0;
  FittedSurface fitted = Fit(region, map, options, unrolled, seam, progress).run();
  fitted.chart = std::move(unrolled);
  return fitted;
}

}  // namespace trimquad
