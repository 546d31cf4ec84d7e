#include "trimquad/spline/moved_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "trimquad/base/error.h"
#include "trimquad/spline/spline_space.h"

namespace trimquad {
namespace {

/// Weight of the plate's energy against an integral of squared distance along the curves: so small that it
/// holds nothing back.
constexpr double kPlate = 1e-9;
/// The same of what joins charts, which the plate must not drown in.
constexpr double kExact = 1;
constexpr int kRoundsOfMove = 12;
/// A direction of the parameter plane takes part in a curve's if it has this much of the other's share.
constexpr double kAxisTakesPart = 0.3;
/// What may be left of the moves where they cannot be followed, by the largest; and by how much less there
/// has to be for more poles.
constexpr double kWorthWhile = 0.1, kWorthMorePoles = 0.7;
/// Narrowest knot spans, quads: narrower ones follow wrinkles only.
constexpr double kNarrowest = 1.0 / 32, kNarrowestFirm = 1.0 / 64;
/// By how much the weight of a firm move that is missed grows in a round, and in all. (after Lawson's
/// algorithm)
constexpr double kMoreAtOnce = 10, kMostMore = 1e4;

/// Empty where inner knots are multiple.
std::optional<SplineLine> lineOf(const std::vector<double>& knots, int degree, bool closed) {
  SplineLine line{degree, closed, {}};
  line.breaks.assign(knots.begin() + degree, knots.end() - degree);
  const auto same = [](double a, double b) { return !(a < b); };
  if (std::adjacent_find(line.breaks.begin(), line.breaks.end(), same) != line.breaks.end()) return {};
  return line;
}

std::optional<SplineSpace> spaceOf(const SplineSurface& surface) {
  auto u = lineOf(surface.knotsU, surface.degreeU, surface.closedU);
  auto v = lineOf(surface.knotsV, surface.degreeV, false);
  if (!u || !v) return {};
  return SplineSpace{std::move(*u), std::move(*v)};
}

/// The bed: points at rest all over the parameter plane.
void appendBed(const SplineSpace& space, double fade, std::vector<Datum>& data) {
  const double weight = kPlate / std::pow(fade, 4);
  const double gauss[] = {0.5 - std::sqrt(1.0 / 12), 0.5 + std::sqrt(1.0 / 12)};
  for (int j = 0; j < space.v.spans(); ++j)
    for (int i = 0; i < space.u.spans(); ++i)
      for (const double x : gauss)
        for (const double y : gauss)
          data.push_back(
              {{space.u.breaks[i] + x * space.u.width(i), space.v.breaks[j] + y * space.v.width(j)},
               Eigen::Vector3d::Zero(),
               weight * space.u.width(i) * space.v.width(j) / 4});
}

void halve(SplineLine& line, std::vector<int> spans) {
  std::sort(spans.begin(), spans.end());
  spans.erase(std::unique(spans.begin(), spans.end()), spans.end());
  for (auto it = spans.rbegin(); it != spans.rend(); ++it)
    line.breaks.insert(line.breaks.begin() + *it + 1, (line.breaks[*it] + line.breaks[*it + 1]) / 2);
}

/// A move, and the chart whose surface it is of.
struct ChartMove {
  int chart;
  SurfaceMove move;
};

/// More knots where the move is missed, in the directions that the curves have there. Whether there are any.
template <class Spaces>
bool refine(Spaces& spaces, const std::vector<ChartMove>& missed) {
  std::map<int, std::array<std::vector<int>, 2>> spans;  // by chart
  for (const auto& [chart, move] : missed) {
    const Eigen::Vector2d share = move.along.cwiseAbs();
    const SplineLine* lines[] = {&spaces.chart(chart).u, &spaces.chart(chart).v};
    for (const int axis : {0, 1}) {
      const int span = lines[axis]->spanOf(move.at[axis]);
      if (share[axis] >= kAxisTakesPart * share[1 - axis] &&
          lines[axis]->width(span) >= 2 * (move.firm ? kNarrowestFirm : kNarrowest))
        spans[chart][axis].push_back(span);
    }
  }
  const int before = spaces.poles();
  for (const auto& [chart, ofChart] : spans) {
    halve(spaces.chart(chart).u, ofChart[0]);
    halve(spaces.chart(chart).v, ofChart[1]);
  }
  return spaces.poles() > before;
}

/// The sum of both, the second over the finer knots.
SplineSurface sum(SplineSurface surface, const SplineSurface& finer) {
  const auto missing = [](const std::vector<double>& knots, const std::vector<double>& all) {
    std::vector<double> added;
    std::set_difference(all.begin(), all.end(), knots.begin(), knots.end(), std::back_inserter(added));
    return added;
  };
  for (const double knot : missing(surface.knotsU, finer.knotsU)) surface = withKnotU(surface, knot);
  for (const double knot : missing(surface.knotsV, finer.knotsV)) surface = withKnotV(surface, knot);
  TRIMQUAD_ASSERT(surface.knotsU == finer.knotsU && surface.knotsV == finer.knotsV);
  for (std::size_t i = 0; i < surface.poles.size(); ++i) surface.poles[i] += finer.poles[i];
  return surface;
}

Fairness plateOver(const SplineSpace& space) {
  return {kPlate, kPlate, {{{space.u.breaks.front(), space.v.breaks.front()}, HUGE_VAL}}};
}

/// The space of one surface.
struct SingleSpace {
  SplineSpace space;

  SplineSpace& chart(int) { return space; }
  std::vector<int> charts() const { return {0}; }
  int poles() const { return space.poles(); }
  std::optional<std::map<int, SplineSurface>> solve(const std::vector<std::vector<Datum>>& data,
                                                    const Progress& progress) const {
    auto way = space.leastSquares(data[0], plateOver(space), progress);
    if (!way) return {};
    return std::map<int, SplineSurface>{{0, std::move(*way)}};
  }
};

/// The spaces of a region's charts, of which some move.
struct ChartSpaces {
  JoinedSpace space;
  std::vector<int> moving;

  SplineSpace& chart(int c) { return space.charts[c]; }
  const std::vector<int>& charts() const { return moving; }
  int poles() const {
    int sum = 0;
    for (const int c : moving) sum += space.charts[c].poles();
    return sum;
  }
  std::optional<std::map<int, SplineSurface>> solve(const std::vector<std::vector<Datum>>& data,
                                                    const Progress& progress) const {
    std::vector<SplineSurface> rest;
    for (const auto& chart : space.charts) {
      rest.push_back(chart.emptySurface());
      rest.back().poles.assign(chart.poles(), Eigen::Vector3d::Zero());
    }
    auto ways =
        space.leastSquares(data, plateOver(space.charts[moving[0]]), moving, std::move(rest), progress);
    if (!ways) return {};
    std::map<int, SplineSurface> result;
    for (const int c : moving) result[c] = std::move((*ways)[c]);
    return result;
  }
};

/// What the surfaces are to be moved by, by chart.
template <class Spaces>
std::optional<std::map<int, SplineSurface>> wayOf(Spaces& spaces, const std::vector<ChartMove>& moves,
                                                  double fade, int maxPoles, const Progress& progress) {
  const int count = spaces.charts().back() + 1;
  double left = 0;  // of the moves, by their errors
  for (const auto& [chart, move] : moves) left = std::max(left, move.by.norm() / move.error);
  left *= kWorthWhile;
  std::optional<std::map<int, SplineSurface>> best;
  std::vector<double> more(moves.size(), 1);  // by move: its weight, by that given
  for (int round = 0; round < kRoundsOfMove && spaces.poles() <= maxPoles; ++round) {
    std::vector<std::vector<Datum>> data(count);
    for (std::size_t i = 0; i < moves.size(); ++i) {
      const auto& [chart, move] = moves[i];
      data[chart].push_back({move.at, move.by, more[i] * move.weight});
    }
    for (const int c : spaces.charts()) appendBed(spaces.chart(c), fade, data[c]);
    auto way = spaces.solve(data, progress);
    if (!way) break;
    std::vector<ChartMove> missed;
    double worst = 0;
    for (std::size_t i = 0; i < moves.size(); ++i) {
      const auto& [chart, move] = moves[i];
      const double off = (way->at(chart).point(move.at[0], move.at[1]) - move.by).norm() / move.error;
      if (off <= 1) continue;
      worst = std::max(worst, off);
      if (move.firm) more[i] = std::min(more[i] * std::min(off, kMoreAtOnce), kMostMore);
      missed.push_back(moves[i]);
    }
    if (missed.empty()) return way;
    if (worst <= (best ? kWorthMorePoles : 1) * left) {
      best = std::move(way);
      left = worst;
    }
    if (!refine(spaces, missed)) break;
  }
  return best;
}

}  // namespace

std::optional<SplineSurface> movedSurface(const SplineSurface& surface, const std::vector<SurfaceMove>& moves,
                                          double fade, int maxPoles, const Progress& progress) {
  auto of = spaceOf(surface);
  if (!of) return {};
  SingleSpace space{std::move(*of)};
  std::vector<ChartMove> all;
  for (const auto& move : moves) {
    all.push_back({0, move});
    all.back().move.at[0] = surface.wrappedU(move.at[0]);
  }
  const auto way = wayOf(space, all, fade, maxPoles, progress);
  if (!way) return {};
  return sum(surface, way->at(0));
}

std::vector<int> movingCharts(const Layout& layout, const std::map<int, std::vector<SurfaceMove>>& moves) {
  std::set<int> moving;
  for (const auto& [chart, ofChart] : moves) moving.insert(chart);
  for (const auto& border : layout.borders)
    for (const int side : {0, 1})
      if (moves.count(border.chart[side])) moving.insert(border.chart[1 - side]);
  return {moving.begin(), moving.end()};
}

std::optional<std::map<int, SplineSurface>> movedSurfaces(
    const std::vector<const SplineSurface*>& surfaces, const Layout& layout, const JoinedKnots& knots,
    const std::map<int, std::vector<SurfaceMove>>& moves, double fade, int maxPoles,
    const Progress& progress) {
  ChartSpaces spaces{JoinedSpace(layout), movingCharts(layout, moves)};
  static_cast<JoinedKnots&>(spaces.space) = knots;
  spaces.space.exactWeight = kExact;
  for (std::size_t c = 0; c < surfaces.size(); ++c) {
    auto own = spaceOf(*surfaces[c]);
    if (!own) return {};
    spaces.space.charts[c] = std::move(*own);
  }
  std::vector<ChartMove> all;
  for (const auto& [chart, ofChart] : moves)
    for (const auto& move : ofChart) all.push_back({chart, move});
  auto ways = wayOf(spaces, all, fade, maxPoles, progress);
  if (!ways) return {};
  for (auto& [chart, way] : *ways) way = sum(*surfaces[chart], way);
  return ways;
}

}  // namespace trimquad
