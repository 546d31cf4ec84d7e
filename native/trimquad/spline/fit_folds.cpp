#include "trimquad/spline/fit_folds.h"

#include <algorithm>
#include <cmath>

namespace trimquad {
namespace {

/// Factor of the fairness around places that stay turned over, each round, and the largest; and how far
/// around, quads.
constexpr double kStiffens = 4, kStiffest = 1e5, kWidestSpot = 1;

/// Factor of the fairness on a knot rectangle where the deviations around it are below the first part of the
/// tolerance; its inverse where they are above the second.
constexpr double kStiffensWithin = 4, kWell = 0.5, kClosely = 0.9;

bool holds(const Fairness::Spot& spot, const FitPlace& x) {
  return spot.chart == x.chart && (spot.at - x.parameter).lpNorm<Eigen::Infinity>() <= spot.reach;
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
    // By the shorter way around a closed surface.
    const auto side = [&](const SurfaceSample& end) {
      Eigen::Vector2d d = end.parameter - a.parameter;
      const double period = surface.lastU() - surface.firstU();
      if (surface.closedU) d[0] -= period * std::round(d[0] / period);
      return d;
    };
    return staysNear(surface, a.parameter, side(b), side(c), region, distance);
  });
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
    if (isNew && reach <= kWidestSpot) spots_.push_back({x.chart, x.parameter, reach, 1});
    coverFolds_ = coverFolds_ && (!isNew || reach <= kWidestSpot);
  }
  for (std::size_t k = 0; k < before; ++k) {
    if (fails[k])
      spots_[k].factor /= kStiffens;
    else if (folded[k])
      spots_[k].factor = std::min(kStiffens * spots_[k].factor, kStiffest);
  }
}

}  // namespace trimquad
