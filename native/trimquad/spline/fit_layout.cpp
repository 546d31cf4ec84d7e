#include "trimquad/spline/fit_layout.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "trimquad/spline/fit_rounds.h"
#include "trimquad/spline/joined_space.h"
#include "trimquad/spline/knot_refinement.h"
#include "trimquad/spline/layout_samples.h"

namespace trimquad {
namespace {

constexpr int kRoundsOfLayout = 60;
constexpr int kPolesOfLayout = 200000;
/// Charts that a foot may cross on its way.
constexpr int kMaxHops = 4;
/// Factor of the tangents' weight at singularities for every refinement that brought little.
constexpr double kTangentGivesWay = 0.1;
/// Factor of the reach of the stiff surroundings of a singularity where samples fail in them.
constexpr double kSoftens = 0.25;
/// Fairness where surfaces are turned over is as strong as on whole quads first, which can keep them from the
/// tolerance; where they come within so many tolerances only, it grows from little instead.
constexpr double kWorthGentleness = 2.5;
constexpr FoldSpots::Policy kGentle = {.strength = 1000, .step = 8};
/// Tolerance under which the parameters' bends within the sectors of a singularity count, quads.
constexpr double kFine = 0.01;
/// Radians between the surfaces next to singularities that weigh as much as a deviation by the tolerance.
constexpr double kKink = 2e-3;
/// Knots at these distances from singularities, where the surfaces bend from one sector's shape to the
/// grid's.
constexpr double kKnotsAround[] = {1, 2};
constexpr double kOnLine = 1e-9;  ///< quads
/// How much wider the knot intervals on one side of a border may be than on the other where surfaces are
/// turned over.
constexpr double kGrading = 1.5;

/// A border as one of its charts sees it.
struct BorderSide {
  const Layout::Border* border;
  int side;
  Eigen::Vector2d start, along, inward;  ///< unit vectors of the grid
  double length;
  Transition over;  ///< into the neighbour's plane
  int neighbour;
  bool endsInside[2];  ///< whether its ends lie inside the surface

  bool holds(const Eigen::Vector2d& x) const {
    const double s = (x - start).dot(along);
    return std::abs((x - start).dot(inward)) <= kOnLine && s >= 0 && s <= length;
  }
  Eigen::AlignedBox2d box() const {
    const Eigen::Vector2d end = start + length * along;
    return {start.cwiseMin(end), start.cwiseMax(end)};
  }
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

class LayoutFit : public FitRounds {
 public:
  LayoutFit(const Region& region, const GridMap& map, const Layout& layout, const FitOptions& options,
            const FoldSpots::Policy& folds, const Progress& progress)
      : FitRounds(region, options,
                  {.maxRounds = kRoundsOfLayout,
                   .maxPoles = kPolesOfLayout,
                   .takesBack = true,
                   .failsAtFeet = false,
                   .several = true,
                   .folds = folds},
                  progress),
        layout_(layout),
        sides_(borderSides(layout)),
        space_(layout),
        singular_(space_.singularCorners()),
        source_(region, map, layout, progress) {
    for (int c = 0; c < int(layout.charts.size()); ++c)
      space_.charts.push_back(initialSpace(c, options.degree));
    setScale(surfaceArea(map.mesh), source_.mapArea(), source_.triangleExtent());
    source_.flattens = toleranceInQuads_ < kFine;
    space_.tangentWeight = std::min(space_.tangentWeight, std::pow(toleranceInQuads_ / kKink, 2));
  }

 private:
  int charts() const override { return int(space_.charts.size()); }
  const SplineSpace& space(int chart) const override { return space_.charts[chart]; }
  std::vector<SurfaceSample> makeSamples(bool control) override {
    auto samples = source_.make(space_, control, threads_, progress_);
    if (!control) space_.alignTangents(dataOf(samples, std::vector<double>(samples.size(), 1)));
    return samples;
  }
  const std::vector<std::array<int, 3>>& cells() const override { return source_.cells(); }
  std::optional<std::vector<SplineSurface>> leastSquares(
      const std::vector<std::vector<Datum>>& data) const override {
    return space_.leastSquares(data, fairness_, progress_);
  }
  std::optional<std::vector<SplineSurface>> partOfLeastSquares(
      const std::vector<std::vector<Datum>>& data, const std::vector<int>& chosen,
      std::vector<SplineSurface> surfaces) const override {
    return space_.leastSquares(data, fairness_, chosen, std::move(surfaces), progress_);
  }
  JoinedKnots* joinedKnots() override { return &space_; }
  void halveKnots(const std::vector<int>& chosen) override {
    for (const int c : chosen)
      for (SplineLine* line : {&space_.charts[c].u, &space_.charts[c].v}) {
        std::vector<double> middles;
        for (int i = 0; i < line->spans(); ++i)
          if (line->width(i) > narrowest_) middles.push_back((line->breaks[i] + line->breaks[i + 1]) / 2);
        for (const double x : middles) {
          line->breaks.insert(std::upper_bound(line->breaks.begin(), line->breaks.end(), x), x);
          auto& surface = result_.surfaces[c];
          surface = line == &space_.charts[c].u ? withKnotU(surface, x) : withKnotV(surface, x);
        }
      }
  }

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
      for (const auto& corner : singular_[c])
        for (const double d : kKnotsAround)
          for (const double at : {corner[axis] - d, corner[axis] + d})
            if (at > low && at < high) fixed.insert(at);
      for (const auto& side : sides_[c])
        for (const double s : {0.0, side.length})
          if (side.endsInside[s > 0] || side.along[axis] == 0) {
            fixed.insert((side.start + s * side.along)[axis]);
          } else if (const double out = (s > 0 ? 1 : -1) * side.along[axis]; goesOnBeyond(c, side, s)) {
            // Across a hole both stretches of the line go their own ways: they need not fit together there.
            const double end = (side.start + s * side.along)[axis];
            const double first = out > 0 ? std::ceil(end + JoinedSpace::kBeyondBoundary)
                                         : std::floor(end - JoinedSpace::kBeyondBoundary);
            for (int k = 0; k < degree; ++k)
              if (const double at = first + k * out; at > low && at < high) fixed.insert(at);
          }
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

  /// Whether another border of the chart lies on the same line, beyond an end of this one.
  bool goesOnBeyond(int c, const BorderSide& side, double end) const {
    return std::any_of(sides_[c].begin(), sides_[c].end(), [&](const BorderSide& other) {
      if (other.along[0] * side.along[1] != other.along[1] * side.along[0]) return false;
      const Eigen::Vector2d away = other.start - side.start;
      if (away.dot(side.inward) != 0) return false;
      const double a = away.dot(side.along), b = a + other.length * other.along.dot(side.along);
      return end > 0 ? std::min(a, b) > end : std::max(a, b) < end;
    });
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

  /// There the surfaces' parameters are bent sharply, and feet would pile up on some of their sheets.
  bool isHeld(const SurfaceSample& s) const override {
    const auto& corners = singular_[s.chart];
    for (std::size_t k = 0; k < corners.size(); ++k)
      if ((corners[k] - s.parameter).norm() < space_.stiffReach[s.chart][k]) return true;
    return false;
  }

  std::optional<Eigen::Vector2d> seenFrom(int chart, const FitPlace& x) const override {
    if (x.chart == chart) return x.parameter;
    std::optional<Eigen::Vector2d> nearest;
    double least = std::numeric_limits<double>::infinity();
    for (const auto& side : sides_[x.chart]) {
      if (side.neighbour != chart || side.border->feature) continue;
      const Eigen::Vector2d end = side.start + side.length * side.along;
      const double distance =
          (x.parameter - x.parameter.cwiseMax(side.start.cwiseMin(end)).cwiseMin(side.start.cwiseMax(end)))
              .norm();
      if (distance >= least) continue;
      least = distance;
      nearest = Layout::apply(side.over, layout_.scale, x.parameter);
    }
    return nearest;
  }
  bool isInChart(const FitPlace& x) const override {
    return std::none_of(sides_[x.chart].begin(), sides_[x.chart].end(), [&](const BorderSide& side) {
      const double s = (x.parameter - side.start).dot(side.along);
      return s >= 0 && s <= side.length && (x.parameter - side.start).dot(side.inward) < 0;
    });
  }

  bool isOnCrease(const FitPlace& x) const override {
    return std::any_of(sides_[x.chart].begin(), sides_[x.chart].end(), [&](const BorderSide& side) {
      return side.border->feature && side.holds(x.parameter);
    });
  }

  /// Twice in each knot interval of the finer side.
  std::vector<FitPlace> borderPlaces() const override {
    std::vector<FitPlace> result;
    for (const auto& border : layout_.borders) {
      std::set<double> breaks{0, border.length()};
      for (const int side : {0, 1}) {
        const int axis = 1 - border.axis(side);
        const auto& space = space_.charts[border.chart[side]];
        const double start = border.start[side][axis], way = border.end[side][axis] - start;
        for (const double x : (axis == 0 ? space.u : space.v).breaks)
          if (const double s = (x - start) * (way > 0 ? 1 : -1); s > 0 && s < border.length())
            breaks.insert(s);
      }
      const Eigen::Vector2d along = (border.end[0] - border.start[0]) / border.length();
      for (auto at = breaks.begin(); std::next(at) != breaks.end(); ++at)
        for (const double part : {0.25, 0.75})
          result.push_back(
              {border.chart[0], border.start[0] + (*at + part * (*std::next(at) - *at)) * along});
    }
    return result;
  }

  /// The foot of a point on the surfaces, from a place near it, over borders where need be.
  Foot foot(const Eigen::Vector3d& p, const FitPlace& from) const override {
    const auto distance = [&](const FitPlace& x) {
      return (result_.surfaces[x.chart].point(x.parameter[0], x.parameter[1]) - p).norm();
    };
    for (const auto& side : sides_[from.chart])
      if (side.border->feature && side.holds(from.parameter)) return {footOnLine(p, side, from), from};
    FitPlace start = from;
    FitPlace at{from.chart, result_.surfaces[from.chart].footPoint(p, from.parameter, kFootStep)};
    for (int hop = 0; hop < kMaxHops; ++hop) {
      struct Crossing {
        FitPlace start, at;
        double distance;
        bool beyond;
      };
      std::optional<Crossing> best;
      const BorderSide* crease = nullptr;
      for (const auto& side : sides_[at.chart]) {
        const double depth = (at.parameter - side.start).dot(side.inward);
        const double before = (start.parameter - side.start).dot(side.inward);
        if (depth > kOnLine || before < -kOnLine) continue;
        // Where the way from the start meets the line.
        const double part = before - depth > kOnLine ? before / (before - depth) : 1;
        const double s =
            (start.parameter + part * (at.parameter - start.parameter) - side.start).dot(side.along);
        constexpr double kBeyond = JoinedSpace::kBeyondBoundary;
        const double low = side.endsInside[0] ? 0 : -kBeyond,
                     high = side.length + (side.endsInside[1] ? 0 : kBeyond);
        if (s < low - kOnLine || s > high + kOnLine) continue;
        // A crease's other side is another sheet.
        if (side.border->feature) {
          crease = &side;
          continue;
        }
        const Eigen::Vector2d guess = Layout::apply(side.over, layout_.scale, at.parameter);
        const FitPlace next{side.neighbour, result_.surfaces[side.neighbour].footPoint(p, guess, kFootStep)};
        const Crossing crossing{{side.neighbour, Layout::apply(side.over, layout_.scale, start.parameter)},
                                next,
                                distance(next),
                                depth < -kOnLine};
        if (!best || (crossing.beyond && !best->beyond) ||
            (crossing.beyond == best->beyond && crossing.distance < best->distance))
          best = crossing;
      }
      if (crease) return {footOnLine(p, *crease, at), start, true};
      if (!best || (!best->beyond && !(best->distance < distance(at) * (1 - 1e-9)))) break;
      start = best->start;
      at = best->at;
    }
    return {at, start};
  }

  /// The same on a side of a chart.
  FitPlace footOnLine(const Eigen::Vector3d& p, const BorderSide& side, const FitPlace& from) const {
    return {from.chart, result_.surfaces[from.chart].footPoint(p, from.parameter, side.box(), kFootStep)};
  }

  /// What stalls next to a singularity may be held by the tangents there.
  void giveWay() override { space_.tangentWeight *= kTangentGivesWay; }

  /// Where samples fail though knots are narrower than the stiff surroundings of a singularity, these shrink.
  void softenSingularities() {
    std::set<std::pair<int, int>> softer;
    for (const auto& x : failing_) {
      const double interval = knotInterval(x);
      for (std::size_t k = 0; k < singular_[x.chart].size(); ++k) {
        double& reach = space_.stiffReach[x.chart][k];
        if (interval < reach && (singular_[x.chart][k] - x.parameter).norm() < reach + interval)
          softer.insert({x.chart, int(k)});
      }
    }
    for (const auto& [chart, k] : softer) space_.stiffReach[chart][k] *= kSoftens;
  }

  /// A border's curve has only knots that both sides have: where it fails, or where the finer side's next
  /// poles go another way than it and fold over, the coarser side is to be refined too.
  void addCoarser(const FitPlace& x, double coarserBy, std::set<std::tuple<int, int, int>>& coarser) const {
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
      if (theirs.width(span) > coarserBy * line.width(line.spanOf(x.parameter[runs])))
        coarser.insert({side.neighbour, axis, span});
    }
  }

  bool insertKnots() override {
    softenSingularities();
    std::vector<std::vector<Eigen::Vector2d>> failingIn(space_.charts.size());
    for (const auto& x : failing_) failingIn[x.chart].push_back(x.parameter);
    std::set<std::tuple<int, int, int>> coarser;  // chart, axis, span
    for (const auto& x : failing_) addCoarser(x, 0.75, coarser);
    for (const auto& x : turned_) addCoarser(x, kGrading, coarser);
    std::vector<std::tuple<int, int, double>> middles;
    for (const auto& [chart, axis, span] : coarser) {
      const SplineLine& line = axis == 0 ? space_.charts[chart].u : space_.charts[chart].v;
      middles.emplace_back(chart, axis, (line.breaks[span] + line.breaks[span + 1]) / 2);
    }
    const auto before = space_.charts;
    bool any = false;
    // By chart: its samples, and the cells that lie in it as a whole.
    std::vector<std::vector<SurfaceSample>> samplesIn(space_.charts.size());
    std::vector<std::vector<std::array<int, 3>>> cellsIn(space_.charts.size());
    std::vector<int> number;
    for (const auto& s : samples_) {
      number.push_back(int(samplesIn[s.chart].size()));
      samplesIn[s.chart].push_back(s);
    }
    for (const auto& [i, j, k] : cells_)
      if (const int c = samples_[i].chart; samples_[j].chart == c && samples_[k].chart == c)
        cellsIn[c].push_back({number[i], number[j], number[k]});
    for (std::size_t c = 0; c < space_.charts.size(); ++c)
      if (!failingIn[c].empty())
        any |= refineKnots(space_.charts[c], samplesIn[c], cellsIn[c], failingIn[c], narrowest_);
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

  const Layout& layout_;
  std::vector<std::vector<BorderSide>> sides_;  ///< by chart
  JoinedSpace space_;
  std::vector<std::vector<Eigen::Vector2d>> singular_;  ///< corners of charts in singularities, by chart
  LayoutSamples source_;
};

}  // namespace

FittedSurface fitLayout(const Region& region, const GridMap& map, Layout layout, const FitOptions& options,
                        const Progress& progress) {
  const auto take = [&](FittedSurface fitted) {
    fitted.layout = std::move(layout);
    return fitted;
  };
  LayoutFit fit(region, map, layout, options, {}, progress);
  try {
    return take(fit.run());
  } catch (const Error& error) {
    if (error.kind() != Error::Kind::Stage || !(fit.closest() <= kWorthGentleness * options.tolerance)) throw;
  }
  return take(LayoutFit(region, map, layout, options, kGentle, progress).run());
}

std::optional<FittedSurface> closerCharts(const FittedSurface& fitted, const std::vector<int>& chosen,
                                          const Region& region, const GridMap& map, const FitOptions& options,
                                          const Progress& progress) {
  return LayoutFit(region, map, *fitted.layout, options, {}, progress).closer(fitted, chosen);
}

std::optional<FittedSurface> smoothedCharts(const FittedSurface& fitted, const std::map<int, int>& steps,
                                            const Region& region, const GridMap& map,
                                            const FitOptions& options, const Progress& progress) {
  return LayoutFit(region, map, *fitted.layout, options, {}, progress).smoothed(fitted, steps);
}

}  // namespace trimquad
