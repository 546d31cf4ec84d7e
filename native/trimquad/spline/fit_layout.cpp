#include "trimquad/spline/fit_layout.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <set>

#include "trimquad/base/error.h"
#include "trimquad/base/parallel.h"
#include "trimquad/spline/deviation.h"
#include "trimquad/spline/joined_space.h"
#include "trimquad/spline/knot_refinement.h"
#include "trimquad/spline/layout_samples.h"

namespace trimquad {
namespace {

constexpr int kMaxRounds = 60;
constexpr int kMaxPoles = 200000;
// As for a single surface.
constexpr int kMaxCorrections = 4;
constexpr double kCorrectionPays = 0.85;
constexpr double kCorrectionStarts = 20;
constexpr double kCorrectedWins = 0.7;
constexpr double kEmphasis = 10;
constexpr double kWorstPart = 0.3;
constexpr int kPatience = 4;
/// Charts that a foot may cross on its way.
constexpr int kMaxHops = 4;
/// Factor of the tangents' weight at singularities for every refinement that brought little.
constexpr double kTangentGivesWay = 0.1;
constexpr double kOnLine = 1e-9;  ///< quads

struct Place {
  int chart;
  Eigen::Vector2d parameter;
};

std::string shortNumber(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", x);
  return text;
}

/// A border as one of its charts sees it.
struct BorderSide {
  const Layout::Border* border;
  int side;
  Eigen::Vector2d start, along, inward;  ///< unit vectors of the grid
  double length;
  Transition over;  ///< into the neighbour's plane
  int neighbour;
  bool endsInside[2];  ///< whether its ends lie inside the surface
};

std::vector<std::vector<BorderSide>> borderSides(const Layout& layout) {
  std::vector<std::vector<BorderSide>> result(layout.charts.size());
  for (const auto& border : layout.borders)
    for (int side : {0, 1}) {
      const Eigen::Vector2d along = (border.end[side] - border.start[side]) / border.length();
      const Eigen::Vector2d left(-along[1], along[0]);
      result[border.chart[side]].push_back(
          {&border,
           side,
           border.start[side],
           along,
           side == 0 ? left : Eigen::Vector2d(-left),
           border.length(),
           side == 0 ? border.across : border.across.inverse(),
           border.chart[1 - side],
           {layout.points[border.startPoint].inner(), layout.points[border.endPoint].inner()}});
    }
  return result;
}

class LayoutFit {
 public:
  LayoutFit(const Region& region, const GridMap& map, const Layout& layout, const FitOptions& options,
            const Progress& progress)
      : region_(region),
        layout_(layout),
        tolerance_(options.tolerance),
        enough_(std::max(options.tolerance, options.enough)),
        threads_(options.threads),
        progress_(progress),
        sides_(borderSides(layout)),
        space_(layout),
        singular_(space_.singularCorners()),
        source_(region, map, layout, progress) {
    for (int c = 0; c < int(layout.charts.size()); ++c)
      space_.charts.push_back(initialSpace(c, options.degree));
    const double quad = std::sqrt(surfaceArea(map.mesh) / source_.mapArea());
    const double inQuads = tolerance_ / quad;
    fairness_.withData = std::max(1e-3 * inQuads * inQuads, 1e-13);
    fairness_.withoutData = std::max(1e3 * fairness_.withData, 1e-9);
    narrowest_ = std::exp2(std::floor(std::log2(source_.triangleExtent() / 16)));
  }

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
        if (corrections_ > 0 && deviation_.max > before_.deviation.max) takeBack();
        refine();
        chooseParameters();
      }
    }
    throw unreachable();
  }

 private:
  /// Two spans along the longer side, room beyond the surface's boundary, and a knot wherever a border ends.
  SplineSpace initialSpace(int c, int degree) const {
    const auto& chart = layout_.charts[c];
    const Eigen::Vector2d extent = chart.high - chart.low;
    const double room = std::max(0.5, 0.01 * extent.maxCoeff()), span = std::max(1.0, extent.maxCoeff() / 2);
    SplineLine lines[2];
    for (int axis = 0; axis < 2; ++axis) {
      const double low = std::floor(chart.low[axis] - (needsRoom(c, axis, chart.low[axis], room) ? room : 0));
      const double high =
          std::ceil(chart.high[axis] + (needsRoom(c, axis, chart.high[axis], room) ? room : 0));
      std::set<double> fixed{low, high};
      for (const auto& side : sides_[c])
        for (const double s : {0.0, side.length})
          if (side.endsInside[s > 0] || side.along[axis] == 0)
            fixed.insert((side.start + s * side.along)[axis]);
      lines[axis].degree = degree;
      for (auto at = fixed.begin(); std::next(at) != fixed.end(); ++at) {
        const double a = *at, b = *std::next(at);
        const int parts = std::max(1, int(std::lround((b - a) / span)));
        for (int k = 0; k < parts; ++k) lines[axis].breaks.push_back(std::round(a + (b - a) * k / parts));
      }
      lines[axis].breaks.push_back(high);
    }
    return {lines[0], lines[1]};
  }

  /// Whether the surface's boundary comes close to that side of the chart's bounding box, where no border
  /// lies on it.
  bool needsRoom(int c, int axis, double at, double room) const {
    const auto isBehindBorder = [&](const Eigen::Vector2d& x) {
      return std::any_of(sides_[c].begin(), sides_[c].end(), [&](const BorderSide& side) {
        if (side.along[axis] != 0 || side.start[axis] != at) return false;
        const double s = (x - side.start).dot(side.along);
        return s > -room && s < side.length + room;
      });
    };
    for (const auto& loop : layout_.charts[c].loops)
      for (const auto& stretch : loop)
        for (const auto& p : stretch.boundary)
          if (std::abs(p.at[axis] - at) < room && !isBehindBorder(p.at)) return true;
    return false;
  }

  void makeSamples() {
    samples_ = source_.make(space_, false, progress_);
    cells_ = source_.cells();
    emphasis_.assign(samples_.size(), 1);
  }

  void solve() {
    std::vector<std::vector<Datum>> data(space_.charts.size());
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const auto& s = samples_[i];
      data[s.chart].push_back({s.parameter, s.point, s.weight * emphasis_[i]});
    }
    auto surfaces = space_.leastSquares(data, fairness_, progress_);
    for (int attempt = 0; !surfaces && attempt < 4; ++attempt) {
      stiffen(100);
      surfaces = space_.leastSquares(data, fairness_, progress_);
    }
    if (!surfaces) throw stageError("fit", "the normal equations of the surfaces are singular", region_.name);
    result_.surfaces = std::move(*surfaces);
    previous_ = deviation_;
    deviation_ = measure(samples_, feet_);
    failing_ = failing(samples_, threshold(deviation_.max));
  }

  /// There the surfaces' parameters are bent sharply, and feet would pile up on some of their sheets.
  bool isNextToSingularity(const LayoutSample& s) const {
    return std::any_of(singular_[s.chart].begin(), singular_[s.chart].end(),
                       [&](const Eigen::Vector2d& x) { return (x - s.parameter).norm() < kStiffReach; });
  }

  /// The foot of a point on the surfaces, from a place near it, over borders where need be.
  Place foot(const Eigen::Vector3d& p, Place from, Place& start) const {
    const auto distance = [&](const Place& x) {
      return (result_.surfaces[x.chart].point(x.parameter[0], x.parameter[1]) - p).norm();
    };
    Place at{from.chart, result_.surfaces[from.chart].footPoint(p, from.parameter, kFootStep)};
    start = from;
    for (int hop = 0; hop < kMaxHops; ++hop) {
      struct Crossing {
        Place start, at;
        double distance;
        bool beyond;
      };
      std::optional<Crossing> best;
      for (const auto& side : sides_[at.chart]) {
        const double depth = (at.parameter - side.start).dot(side.inward);
        const double before = (start.parameter - side.start).dot(side.inward);
        // A crease's other side is another sheet.
        if (depth > kOnLine || before < -kOnLine || side.border->feature) continue;
        // Where the way from the start meets the line.
        const double part = before - depth > kOnLine ? before / (before - depth) : 1;
        const double s =
            (start.parameter + part * (at.parameter - start.parameter) - side.start).dot(side.along);
        const double low = side.endsInside[0] ? 0 : -0.5, high = side.length + (side.endsInside[1] ? 0 : 0.5);
        if (s < low - kOnLine || s > high + kOnLine) continue;
        const Eigen::Vector2d guess = Layout::apply(side.over, layout_.scale, at.parameter);
        const Place next{side.neighbour, result_.surfaces[side.neighbour].footPoint(p, guess, kFootStep)};
        const Crossing crossing{{side.neighbour, Layout::apply(side.over, layout_.scale, start.parameter)},
                                next,
                                distance(next),
                                depth < -kOnLine};
        if (!best || (crossing.beyond && !best->beyond) ||
            (crossing.beyond == best->beyond && crossing.distance < best->distance))
          best = crossing;
      }
      if (!best || (!best->beyond && !(best->distance < distance(at) * (1 - 1e-9)))) break;
      start = best->start;
      at = best->at;
    }
    return at;
  }

  Deviation measure(std::vector<LayoutSample>& samples, std::vector<Place>& feet) const {
    feet.resize(samples.size());
    std::vector<char> turnedOver(samples.size(), 0);
    parallelParts(int(samples.size()), threads_, [&](int begin, int end) {
      progress_.check();
      for (int i = begin; i < end; ++i) {
        auto& s = samples[i];
        const Place from{s.chart, s.parameter};
        Place start{};
        const Place at = foot(s.point, from, start);
        const auto jet = result_.surfaces[at.chart].jet(at.parameter[0], at.parameter[1]);
        const Eigen::Vector3d normal = jet.su.cross(jet.sv), d = s.point - jet.s;
        s.distance = d.dot(normal) < 0 ? -d.norm() : d.norm();
        const auto& space = space_.charts[at.chart];
        const Eigen::Vector2d move = (at.parameter - start.parameter).cwiseAbs();
        const bool near = move[0] <= space.u.width(space.u.spanOf(at.parameter[0])) &&
                          move[1] <= space.v.width(space.v.spanOf(at.parameter[1]));
        turnedOver[i] = !s.agrees(normal);
        feet[i] = near && !turnedOver[i] && !isNextToSingularity(s) ? at : from;
      }
    });
    return deviationOf(samples, turnedOver);
  }

  static std::vector<Place> failing(const std::vector<LayoutSample>& samples, double tolerance) {
    std::vector<Place> result;
    for (const auto& s : samples)
      if (!(std::abs(s.distance) <= tolerance)) result.push_back({s.chart, s.parameter});
    return result;
  }

  void moveTo(const std::vector<Place>& places) {
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      samples_[i].chart = places[i].chart;
      samples_[i].parameter = places[i].parameter;
    }
  }

  /// Takes back a correction that made things worse.
  void takeBack() {
    samples_ = std::move(before_.samples);
    feet_ = std::move(before_.feet);
    failing_ = std::move(before_.failing);
    result_.surfaces = std::move(before_.surfaces);
    deviation_ = before_.deviation;
  }

  void correct() {
    ++corrections_;
    before_ = {samples_, feet_, failing_, result_.surfaces, deviation_};
    moveTo(feet_);
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const double part = samples_[i].distance / deviation_.max;
      emphasis_[i] = 0.5 * (emphasis_[i] + 1 + kEmphasis * part * part);
    }
  }

  void chooseParameters() {
    const bool corrected = corrections_ > 0;
    corrections_ = 0;
    makeSamples();
    if (!corrected) return;
    std::vector<Place> ofMap;
    for (const auto& s : samples_) ofMap.push_back({s.chart, s.parameter});
    measure(samples_, feet_);
    const auto feet = feet_;
    moveTo(feet);
    solve();
    const Deviation withFeet = deviation_;
    auto surfaces = result_.surfaces;
    const auto samples = samples_;
    const auto feetAfter = feet_;
    const auto failed = failing_;
    moveTo(ofMap);
    solve();
    if (withFeet.turnedOver == 0 && withFeet.max < kCorrectedWins * deviation_.max) {
      samples_ = samples;
      result_.surfaces = std::move(surfaces);
      deviation_ = withFeet;
      feet_ = feetAfter;
      failing_ = failed;
    }
    solved_ = true;
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
    std::vector<Place> feet;
    const Deviation found = measure(control, feet);
    result_.maxDeviation = std::max(found.max, deviation_.max);
    result_.rmsDeviation = found.rms;
    result_.rounds = rounds_;
    if (found.max <= tolerance && found.turnedOver == 0) return true;
    failing_ = failing(control, threshold(found.max));
    deviation_.turnedOver = found.turnedOver;
    return false;
  }

  double threshold(double largest) const {
    return thorough_ ? tolerance_ : std::max(tolerance_, kWorstPart * largest);
  }
  bool stalled() const { return best_ > 0.5 * atRefinement_; }

  bool correctionPays() const {
    const bool early = deviation_.max > kCorrectionStarts * tolerance_ && !stalled();
    if (deviation_.turnedOver > kFewTurned * double(samples_.size())) return false;
    if (deviation_.max <= tolerance_ || early || corrections_ >= kMaxCorrections) return false;
    return corrections_ == 0 || deviation_.max <= kCorrectionPays * previous_.max ||
           deviation_.rms <= kCorrectionPays * previous_.rms;
  }

  void refine() {
    if (failing_.empty()) {
      if (++stiffened_ > 3)
        throw stageError("fit", "the surface folds over; use a smaller edge length, or cut the region there",
                         region_.name, samples_[std::max(0, deviation_.firstTurned)].point);
      stiffen(30);
      return;
    }
    idle_ = best_ < 0.8 * atRefinement_ ? 0 : idle_ + 1;
    thorough_ = stalled();
    atRefinement_ = best_;
    // What stalls next to a singularity may be held by the tangents there.
    if (idle_ > 0) space_.tangentWeight *= kTangentGivesWay;
    if (idle_ > kPatience || !insertKnots() || space_.poles() > kMaxPoles) throw unreachable();
  }

  bool insertKnots() {
    std::vector<std::vector<Eigen::Vector2d>> failingIn(space_.charts.size());
    for (const auto& x : failing_) failingIn[x.chart].push_back(x.parameter);
    // A border's curve has only knots that both sides have: where it fails, the coarser side is refined too.
    std::set<std::tuple<int, int, int>> coarser;  // chart, axis, span
    for (const auto& x : failing_) {
      const auto& own = space_.charts[x.chart];
      for (const auto& side : sides_[x.chart]) {
        const int runs = side.along[0] != 0 ? 0 : 1;
        const SplineLine &line = runs == 0 ? own.u : own.v, &over = runs == 0 ? own.v : own.u;
        const double depth = (x.parameter - side.start).dot(side.inward),
                     s = (x.parameter - side.start).dot(side.along);
        if (s < 0 || s > side.length || depth < -kOnLine) continue;
        if (depth > over.width(over.spanOf((x.parameter - (depth - 1e-6) * side.inward)[1 - runs]))) continue;
        const Eigen::Vector2d there = Layout::apply(side.over, layout_.scale, side.start + s * side.along);
        const int axis = side.over.rotation % 2 == 0 ? runs : 1 - runs;
        const auto& neighbour = space_.charts[side.neighbour];
        const SplineLine& theirs = axis == 0 ? neighbour.u : neighbour.v;
        const int span = theirs.spanOf(there[axis]);
        if (theirs.width(span) > 0.75 * line.width(line.spanOf(x.parameter[runs])))
          coarser.insert({side.neighbour, axis, span});
      }
    }
    std::vector<std::tuple<int, int, double>> middles;
    for (const auto& [chart, axis, span] : coarser) {
      const SplineLine& line = axis == 0 ? space_.charts[chart].u : space_.charts[chart].v;
      middles.emplace_back(chart, axis, (line.breaks[span] + line.breaks[span + 1]) / 2);
    }
    const auto before = space_.charts;
    bool any = false;
    for (int c = 0; c < int(space_.charts.size()); ++c) {
      if (failingIn[c].empty()) continue;
      std::vector<SurfaceSample> here;
      std::vector<int> number(samples_.size(), -1);
      for (std::size_t i = 0; i < samples_.size(); ++i)
        if (samples_[i].chart == c) {
          number[i] = int(here.size());
          here.push_back(samples_[i]);
        }
      std::vector<std::array<int, 3>> cells;
      for (const auto& cell : cells_)
        if (number[cell[0]] >= 0 && number[cell[1]] >= 0 && number[cell[2]] >= 0)
          cells.push_back({number[cell[0]], number[cell[1]], number[cell[2]]});
      any |= refineKnots(space_.charts[c], here, cells, failingIn[c], narrowest_);
    }
    for (const auto& [chart, axis, at] : middles) {
      const auto widthOf = [&](const SplineSpace& space) {
        const SplineLine& line = axis == 0 ? space.u : space.v;
        return line.width(line.spanOf(at));
      };
      if (widthOf(space_.charts[chart]) == widthOf(before[chart]))
        any |= halveInterval(space_.charts[chart], axis, at, narrowest_);
    }
    return any;
  }

  void stiffen(double factor) {
    fairness_.withData *= factor;
    fairness_.withoutData *= factor;
  }

  Error unreachable() const {
    const auto& where = samples_[std::max(0, deviation_.worst)].point;
    const std::string poles = std::to_string(space_.poles());
    if (best_ <= tolerance_)
      return stageError("fit",
                        "the surface folds over wherever it keeps the tolerance " + shortNumber(tolerance_) +
                            " (" + poles + " poles); use a smaller edge length, or cut the region there",
                        region_.name, where);
    return stageError("fit",
                      "the tolerance " + shortNumber(tolerance_) +
                          " cannot be met, the surfaces come within " + shortNumber(best_) + " with " +
                          poles + " poles; allow a larger tolerance or use a smaller edge length",
                      region_.name, where);
  }

  const Region& region_;
  const Layout& layout_;
  double tolerance_;
  double enough_;
  int threads_;
  const Progress& progress_;
  std::vector<std::vector<BorderSide>> sides_;  ///< by chart
  JoinedSpace space_;
  std::vector<std::vector<Eigen::Vector2d>> singular_;  ///< corners of charts in singularities, by chart
  LayoutSamples source_;
  Fairness fairness_;
  double narrowest_ = 0;
  FittedSurface result_;
  std::optional<FittedSurface> kept_;  ///< within what is enough
  std::vector<LayoutSample> samples_;
  std::vector<std::array<int, 3>> cells_;
  std::vector<double> emphasis_;
  Deviation deviation_, previous_;
  std::vector<Place> failing_, feet_;
  struct {
    std::vector<LayoutSample> samples;
    std::vector<Place> feet, failing;
    std::vector<SplineSurface> surfaces;
    Deviation deviation;
  } before_;  ///< the last correction
  double start_ = 0, best_ = 0, atRefinement_ = std::numeric_limits<double>::infinity();
  bool solved_ = false, thorough_ = false;
  int rounds_ = 0, corrections_ = 0, stiffened_ = 0, idle_ = 0;
};

}  // namespace

FittedSurface fitLayout(const Region& region, const GridMap& map, Layout layout, const FitOptions& options,
                        const Progress& progress) {
  FittedSurface fitted = LayoutFit(region, map, layout, options, progress).run();
  fitted.layout = std::move(layout);
  return fitted;
}

}  // namespace trimquad
