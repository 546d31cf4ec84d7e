#include "trimquad/spline/fit_folds.h"

#include <algorithm>
#include <cmath>

#include "trimquad/base/parallel.h"

namespace trimquad {
namespace {

/// Largest factor of the fairness around places that stay turned over, and how far around, quads.
constexpr double kStiffest = 1e5, kWidestSpot = 1;

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

std::vector<FitPlace> placesAway(const std::vector<SplineSurface>& surfaces,
                                 const std::vector<FitPlace>& feet,
                                 const std::vector<std::array<int, 3>>& cells, const TriangleTree& region,
                                 double distance, int threads, const Progress& progress) {
  std::vector<char> isAway(cells.size(), 0);
  const auto middle = [&](const std::array<int, 3>& cell) {
    const FitPlace& a = feet[cell[0]];
    const auto& surface = surfaces[a.chart];
    const Eigen::Vector2d x = a.parameter + (wayTo(surface, a.parameter, feet[cell[1]].parameter) +
                                             wayTo(surface, a.parameter, feet[cell[2]].parameter)) /
                                                3;
    return Eigen::Vector2d(surface.wrappedU(x[0]), x[1]);
  };
  parallelParts(int(cells.size()), threads, [&](int begin, int end) {
    progress.check();
    for (int k = begin; k < end; ++k) {
      const auto& [i, j, l] = cells[k];
      if (feet[i].chart != feet[j].chart || feet[i].chart != feet[l].chart) continue;
      const Eigen::Vector2d x = middle(cells[k]);
      const Eigen::Vector3d p = surfaces[feet[i].chart].point(x[0], x[1]);
      isAway[k] = region.closest(p).squaredDistance > distance * distance;
    }
  });
  std::vector<FitPlace> result;
  for (std::size_t k = 0; k < cells.size(); ++k)
    if (isAway[k]) result.push_back({feet[cells[k][0]].chart, middle(cells[k])});
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
