#include "trimquad/spline/fit_folds.h"

#include <algorithm>
#include <cmath>

#include "trimquad/base/parallel.h"

namespace trimquad {
namespace {

/// Largest factor of the fairness around places that stay turned over, and how far around, quads.
constexpr double kStiffest = 1e5, kWidestSpot = 1;

/// Looks at a surface between feet that are a knot interval apart, along a side; and between any at most.
constexpr double kLooksPerInterval = 4;
constexpr int kMostLooks = 6;

/// Factor of the fairness on a knot rectangle where the deviations around it are below the first part of the
/// tolerance; its inverse where they are above the second.
constexpr double kStiffensWithin = 4, kWell = 0.5, kClosely = 0.9;

bool holds(const Fairness::Spot& spot, const FitPlace& x) {
  return spot.chart == x.chart && (spot.at - x.parameter).lpNorm<Eigen::Infinity>() <= spot.reach;
}

/// The shorter way around a closed surface.
Eigen::Vector2d wayTo(const SplineSurface& surface, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  Eigen::Vector2d way = to - from;
  const double period = surface.lastU() - surface.firstU();
  if (surface.closedU) way[0] -= period * std::round(way[0] / period);
  return way;
}

/// Whether the surface stays that near all over a triangle of its parameter plane, a corner of it and two
/// sides.
bool staysNear(const SplineSurface& surface, const Eigen::Vector2d& corner, const Eigen::Vector2d& a,
               const Eigen::Vector2d& b, const TriangleTree& region, double distance) {
  constexpr int kSteps = 4;
  for (int i = 0; i <= kSteps; ++i)
    for (int j = 0; i + j <= kSteps; ++j) {
      const Eigen::Vector2d x = corner + (i * a + j * b) / kSteps;
      const Eigen::Vector3d p = surface.point(surface.wrappedU(x[0]), x[1]);
      if (region.closest(p).squaredDistance > distance * distance) return false;
    }
  return true;
}

}  // namespace

std::vector<std::array<int, 3>> cellsAround(const std::vector<std::array<int, 3>>& cells,
                                            const std::vector<int>& chosen) {
  std::vector<char> isChosen(chosen.empty() ? 0 : *std::max_element(chosen.begin(), chosen.end()) + 1, 0);
  for (const int i : chosen) isChosen[i] = 1;
  std::vector<std::array<int, 3>> result;
  for (const auto& cell : cells)
    if (std::any_of(cell.begin(), cell.end(), [&](int i) { return i < int(isChosen.size()) && isChosen[i]; }))
      result.push_back(cell);
  return result;
}

bool stayNear(const std::vector<SplineSurface>& surfaces, const std::vector<SurfaceSample>& samples,
              const std::vector<std::array<int, 3>>& cells, const TriangleTree& region, double distance) {
  return std::all_of(cells.begin(), cells.end(), [&](const std::array<int, 3>& cell) {
    const SurfaceSample &a = samples[cell[0]], &b = samples[cell[1]], &c = samples[cell[2]];
    if (a.chart != b.chart || a.chart != c.chart) return true;
    const auto& surface = surfaces[a.chart];
    return staysNear(surface, a.parameter, wayTo(surface, a.parameter, b.parameter),
                     wayTo(surface, a.parameter, c.parameter), region, distance);
  });
}

BetweenFeet betweenFeet(const std::vector<SplineSurface>& surfaces, const std::vector<SurfaceSample>& samples,
                        const std::vector<FitPlace>& feet, const std::vector<std::array<int, 3>>& cells,
                        const FitView& view, int threads, const Progress& progress) {
  enum class Look { Good, Away, TurnedOver };
  struct Found {
    Look look = Look::Good;
    FitPlace at = {};
  };
  const auto lookAt = [&](const FitPlace& x, const std::array<int, 3>& cell) {
    const auto jet = surfaces[x.chart].jet(x.parameter[0], x.parameter[1]);
    if (view.isAway && view.isAway(x)) return Look::Away;
    const Eigen::Vector3d normal = jet.su.cross(jet.sv);
    const bool agrees =
        std::any_of(cell.begin(), cell.end(), [&](int i) { return samples[i].agrees(normal); });
    return agrees || view.facesLikewise(jet.s, normal) ? Look::Good : Look::TurnedOver;
  };
  const auto lookWithin = [&](int chart, const std::array<int, 3>& cell) -> Found {
    std::array<Eigen::Vector2d, 3> corner;
    for (int k = 0; k < 3; ++k) {
      const auto seen = view.seenFrom(chart, feet[cell[k]]);
      if (!seen) return {};
      corner[k] = k == 0 ? *seen : Eigen::Vector2d(corner[0] + wayTo(surfaces[chart], corner[0], *seen));
    }
    const Eigen::Vector2d a = corner[1] - corner[0], b = corner[2] - corner[0];
    const double extent = std::max({a.norm(), b.norm(), (a - b).norm()});
    const FitPlace first{chart, {surfaces[chart].wrappedU(corner[0][0]), corner[0][1]}};
    const int steps =
        std::clamp(int(std::ceil(kLooksPerInterval * extent / view.knotInterval(first))), 1, kMostLooks);
    for (int i = 0; i < steps; ++i)
      for (int j = 0; i + j < steps; ++j) {
        const Eigen::Vector2d x = corner[0] + ((i + 1. / 3) * a + (j + 1. / 3) * b) / steps;
        const FitPlace at{chart, {surfaces[chart].wrappedU(x[0]), x[1]}};
        if (!view.isInChart(at)) continue;
        if (const Look look = lookAt(at, cell); look != Look::Good) return {look, at};
      }
    return {};
  };
  const auto lookAround = [&](const std::array<int, 3>& cell) {
    std::vector<Found> found;
    for (int corner = 0; corner < 3; ++corner) {
      const int chart = feet[cell[corner]].chart;
      if (std::any_of(cell.begin(), cell.begin() + corner, [&](int i) { return feet[i].chart == chart; }))
        continue;
      if (const Found here = lookWithin(chart, cell); here.look != Look::Good) found.push_back(here);
    }
    return found;
  };
  // Nearly all are good, so that those that are not may be looked at twice.
  std::vector<char> isGood(cells.size(), 1);
  parallelParts(int(cells.size()), threads, [&](int begin, int end) {
    progress.check();
    for (int k = begin; k < end; ++k) isGood[k] = lookAround(cells[k]).empty();
  });
  BetweenFeet result;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    if (isGood[k]) continue;
    for (const auto& [look, at] : lookAround(cells[k])) {
      (look == Look::Away ? result.away : result.turnedOver).push_back(at);
      if (look == Look::TurnedOver) result.turnedOverCells.push_back(int(k));
    }
  }
  return result;
}

RectangleStiffness::RectangleStiffness(const std::vector<const SplineSpace*>& spaces,
                                       const std::map<int, int>& steps)
    : spaces_(spaces), steps_(steps) {
  for (const SplineSpace* space : spaces)
    factors_.emplace_back(std::size_t(space->u.spans()) * space->v.spans(), 1.0);
}

bool RectangleStiffness::update(const std::vector<SurfaceSample>& samples, double tolerance) {
  std::vector<std::vector<double>> largest;  // deviations, by chart and rectangle
  for (const auto& factors : factors_) largest.emplace_back(factors.size(), 0.0);
  for (const auto& s : samples) {
    const SplineLine &u = spaces_[s.chart]->u, &v = spaces_[s.chart]->v;
    const std::size_t i = u.spanOf(s.parameter[0]), j = v.spanOf(s.parameter[1]);
    double& here = largest[s.chart][i + u.spans() * j];
    here = std::max(here, std::abs(s.distance));
  }
  bool any = false;
  for (auto& [chart, left] : steps_) {
    if (left == 0 || chart >= int(spaces_.size())) continue;
    --left;
    any = true;
    updateChart(chart, largest[chart], tolerance);
  }
  return any;
}

void RectangleStiffness::updateChart(int chart, const std::vector<double>& largest, double tolerance) {
  const SplineLine &u = spaces_[chart]->u, &v = spaces_[chart]->v;
  const auto at = [&](int i, int j) {
    if (u.closed) i = (i + u.spans()) % u.spans();
    const bool inside = i >= 0 && i < u.spans() && j >= 0 && j < v.spans();
    return inside ? largest[i + std::size_t(u.spans()) * j] : 0;
  };
  for (int j = 0; j < v.spans(); ++j)
    for (int i = 0; i < u.spans(); ++i) {
      double around = 0;
      for (int dj = -1; dj <= 1; ++dj)
        for (int di = -1; di <= 1; ++di) around = std::max(around, at(i + di, j + dj));
      double& factor = factors_[chart][i + std::size_t(u.spans()) * j];
      if (around <= kWell * tolerance)
        factor *= kStiffensWithin;
      else if (around > kClosely * tolerance)
        factor = std::max(1.0, factor / kStiffensWithin);
    }
}

/// The weight of a knot rectangle goes with the square of its area.
double FoldSpots::firstFactor(double knotInterval) const {
  return policy_.strength ? std::min(1.0, *policy_.strength * std::pow(knotInterval, 4)) : 1;
}

void FoldSpots::update(const std::vector<FitPlace>& folds, const std::vector<FitPlace>& failing,
                       const std::function<double(const FitPlace&)>& knotInterval) {
  const std::size_t before = spots_.size();
  std::vector<char> fails(before, 0), folded(before, 0);
  for (std::size_t k = 0; k < before; ++k)
    for (const auto& x : failing) fails[k] |= holds(spots_[k], x);
  coverFolds_ = !folds.empty();
  for (const auto& x : folds) {
    bool isNew = true;
    for (std::size_t k = 0; k < spots_.size(); ++k) {
      if (!holds(spots_[k], x)) continue;
      isNew = false;
      if (k < before) folded[k] = 1;
    }
    const double reach = knotInterval(x);
    if (isNew && reach <= kWidestSpot) spots_.push_back({x.chart, x.parameter, reach, firstFactor(reach)});
    coverFolds_ = coverFolds_ && (!isNew || reach <= kWidestSpot);
  }
  for (std::size_t k = 0; k < before; ++k) {
    if (fails[k])
      spots_[k].factor /= policy_.step;
    else if (folded[k])
      spots_[k].factor = std::min(policy_.step * spots_[k].factor, kStiffest);
  }
}

}  // namespace trimquad
