#include "trimquad/spline/moved_surface.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "trimquad/base/error.h"
#include "trimquad/spline/spline_space.h"

namespace trimquad {
namespace {

/// Weight of the plate's energy against an integral of squared distance along the curves: so small that it
/// holds nothing back.
constexpr double kPlate = 1e-9;
constexpr int kMaxRounds = 12;
/// A direction of the parameter plane takes part in a curve's if it has this much of the other's share.
constexpr double kTakesPart = 0.3;
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

/// More knots where the move is missed, in the directions that the curves have there. Whether there are any.
bool refine(SplineSpace& space, const std::vector<SurfaceMove>& missed) {
  std::vector<int> spans[2];
  for (const auto& move : missed) {
    const Eigen::Vector2d share = move.along.cwiseAbs();
    const SplineLine* lines[] = {&space.u, &space.v};
    for (const int axis : {0, 1}) {
      const int span = lines[axis]->spanOf(move.at[axis]);
      if (share[axis] >= kTakesPart * share[1 - axis] &&
          lines[axis]->width(span) >= 2 * (move.firm ? kNarrowestFirm : kNarrowest))
        spans[axis].push_back(span);
    }
  }
  const int before = space.poles();
  halve(space.u, spans[0]);
  halve(space.v, spans[1]);
  return space.poles() > before;
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

}  // namespace

std::optional<SplineSurface> movedSurface(const SplineSurface& surface, const std::vector<SurfaceMove>& moves,
                                          double fade, int maxPoles, const Progress& progress) {
  auto u = lineOf(surface.knotsU, surface.degreeU, surface.closedU);
  auto v = lineOf(surface.knotsV, surface.degreeV, false);
  if (!u || !v) return {};
  SplineSpace space{std::move(*u), std::move(*v)};
  const Fairness plate{kPlate, kPlate, {{{space.u.breaks.front(), space.v.breaks.front()}, HUGE_VAL}}};
  double left = 0;  // of the moves, by their errors
  for (const auto& move : moves) left = std::max(left, move.by.norm() / move.error);
  left *= kWorthWhile;
  std::optional<SplineSurface> best;
  std::vector<double> more(moves.size(), 1);  // by move: its weight, by that given
  for (int round = 0; round < kMaxRounds && space.poles() <= maxPoles; ++round) {
    std::vector<Datum> data;
    for (std::size_t i = 0; i < moves.size(); ++i)
      data.push_back(
          {{surface.wrappedU(moves[i].at[0]), moves[i].at[1]}, moves[i].by, more[i] * moves[i].weight});
    appendBed(space, fade, data);
    auto way = space.leastSquares(data, plate, progress);
    if (!way) break;
    std::vector<SurfaceMove> missed;
    double worst = 0;
    for (std::size_t i = 0; i < moves.size(); ++i) {
      SurfaceMove move = moves[i];
      move.at[0] = surface.wrappedU(move.at[0]);
      const double off = (way->point(move.at[0], move.at[1]) - move.by).norm() / move.error;
      if (off <= 1) continue;
      worst = std::max(worst, off);
      if (move.firm) more[i] = std::min(more[i] * std::min(off, kMoreAtOnce), kMostMore);
      missed.push_back(move);
    }
    if (missed.empty()) return sum(surface, *way);
    if (worst <= (best ? kWorthMorePoles : 1) * left) {
      best = std::move(way);
      left = worst;
    }
    if (!refine(space, missed)) break;
  }
  if (!best) return {};
  return sum(surface, *best);
}

}  // namespace trimquad
