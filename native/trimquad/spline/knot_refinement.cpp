#include "trimquad/spline/knot_refinement.h"

#include <cmath>

namespace trimquad {
namespace {

/// A direction takes part once the residual's variation along it is this part of the variation along the
/// other.
constexpr double kTakesPart = 0.4;

bool splits(const SplineLine& line, int span, double narrowest) {
  return line.width(span) >= 2 * narrowest;
}

void halve(SplineLine& line, const std::vector<char>& marked) {
  std::vector<double> breaks;
  for (int i = 0; i < line.spans(); ++i) {
    const double a = line.breaks[i], b = line.breaks[i + 1];
    breaks.push_back(a);
    if (!marked[i]) continue;
    const double middle = 0.5 * (a + b);
    breaks.push_back(b - a >= 2 ? std::floor(middle) : middle);
  }
  breaks.push_back(line.breaks.back());
  line.breaks = std::move(breaks);
}

}  // namespace

std::vector<Eigen::Array2d> residualVariation(const SplineSpace& space,
                                              const std::vector<SurfaceSample>& samples,
                                              const std::vector<std::array<int, 3>>& cells) {
  // By the shorter way around a closed direction.
  const auto difference = [&](const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    Eigen::Vector2d d = to - from;
    const double period = space.u.breaks.back() - space.u.breaks.front();
    if (space.u.closed) d[0] -= period * std::round(d[0] / period);
    return d;
  };
  std::vector<Eigen::Array2d> variation(size_t(space.u.spans()) * space.v.spans(), Eigen::Array2d::Zero());
  for (const auto& cell : cells) {
    const SurfaceSample &p = samples[cell[0]], &q = samples[cell[1]], &r = samples[cell[2]];
    const Eigen::Vector2d a = difference(p.parameter, q.parameter), b = difference(p.parameter, r.parameter);
    const double area = a.x() * b.y() - a.y() * b.x();
    if (!(area > 0)) continue;
    const double da = q.distance - p.distance, db = r.distance - p.distance;
    const Eigen::Array2d gradient((da * b.y() - db * a.y()) / area, (db * a.x() - da * b.x()) / area);
    const int i = space.u.spanOf(p.parameter[0]), j = space.v.spanOf(p.parameter[1]);
    const Eigen::Array2d step(space.u.width(i), space.v.width(j));
    variation[i + size_t(space.u.spans()) * j] += area * (gradient * step).square();
  }
  return variation;
}

std::array<bool, 2> directionsTakingPart(const Eigen::Array2d& variation) {
  const double ratio = kTakesPart * kTakesPart;
  return {variation[0] >= ratio * variation[1], variation[1] >= ratio * variation[0]};
}

bool refineKnots(SplineSpace& space, const std::vector<SurfaceSample>& samples,
                 const std::vector<std::array<int, 3>>& cells, const std::vector<Eigen::Vector2d>& failing,
                 double narrowest) {
  const auto variation = residualVariation(space, samples, cells);
  std::vector<char> inU(space.u.spans(), 0), inV(space.v.spans(), 0);
  bool any = false;
  for (const auto& x : failing) {
    const int i = space.u.spanOf(x[0]), j = space.v.spanOf(x[1]);
    const auto [wantU, wantV] = directionsTakingPart(variation[i + size_t(space.u.spans()) * j]);
    const bool canU = splits(space.u, i, narrowest), canV = splits(space.v, j, narrowest);
    const bool u = canU && (wantU || !canV), v = canV && (wantV || !canU);
    inU[i] |= u;
    inV[j] |= v;
    any |= u || v;
  }
  halve(space.u, inU);
  halve(space.v, inV);
  return any;
}

bool halveInterval(SplineSpace& space, int axis, double at, double narrowest) {
  SplineLine& line = axis == 0 ? space.u : space.v;
  const int span = line.spanOf(at);
  if (!splits(line, span, narrowest)) return false;
  std::vector<char> marked(line.spans(), 0);
  marked[span] = 1;
  halve(line, marked);
  return true;
}

}  // namespace trimquad
