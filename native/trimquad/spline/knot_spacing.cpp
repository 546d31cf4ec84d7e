#include "trimquad/spline/knot_spacing.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "trimquad/spline/knot_refinement.h"

namespace trimquad {
namespace {

/// Part of the densest demand per length that holds at least everywhere, and the largest ratio of the
/// demands of neighbouring spans.
constexpr double kLeastDensity = 0.2, kSteepest = 2;
/// Demand that stands for none.
constexpr double kNone = 1e-9;
/// Deviation of the best splines of a degree on unit intervals, for unit derivatives of order degree + 1.
/// (Favard's constants over powers of pi)
constexpr double kUnitDeviation[] = {1. / 2, 1. / 8, 1. / 24, 5. / 384, 1. / 240, 61. / 46080};

const SplineLine& lineOf(const SplineSpace& space, int axis) {
  return axis == 0 ? space.u : space.v;
}

/// Derivatives of the order of the degree, which are constant along a span: weights of its poles.
std::vector<std::vector<double>> highestDerivatives(const std::vector<double>& knots,
                                                    const SplineLine& line) {
  std::vector<std::vector<double>> result;
  BasisFunctions basis;
  for (int i = 0; i < line.spans(); ++i) {
    basisFunctions(knots, line.degree, 0.5 * (line.breaks[i] + line.breaks[i + 1]), line.degree, basis);
    const auto& weights = basis.value[line.degree];
    result.emplace_back(weights.begin(), weights.begin() + line.degree + 1);
  }
  return result;
}

/// By span of a line: root mean square, over the samples, of the derivative of order degree + 1 along it, in
/// the direction of the normal there.
std::vector<double> bendingAlong(int axis, const SplineSurface& surface, const SplineSpace& space,
                                 const std::vector<SurfaceSample>& samples) {
  const SplineLine &line = lineOf(space, axis), &other = lineOf(space, 1 - axis);
  const auto& knots = axis == 0 ? surface.knotsU : surface.knotsV;
  const auto& otherKnots = axis == 0 ? surface.knotsV : surface.knotsU;
  const auto derivative = highestDerivatives(knots, line);
  std::vector<double> result(line.spans(), 0), weight(line.spans(), 0);
  BasisFunctions basis;
  for (const auto& s : samples) {
    const int span = line.spanOf(s.parameter[axis]);
    basisFunctions(otherKnots, other.degree, s.parameter[1 - axis], 0, basis);
    const auto highest = [&](int at) {
      double sum = 0;
      for (int a = 0; a <= line.degree; ++a)
        for (int b = 0; b <= other.degree; ++b) {
          const int i = at + a, j = basis.first + b;
          sum += derivative[at][a] * basis.value[0][b] *
                 s.normal.dot(axis == 0 ? surface.pole(i, j) : surface.pole(j, i));
        }
      return sum;
    };
    const double here = highest(span);
    double sum = 0, length = 0;
    for (const int beside : {span - 1, span + 1}) {
      if (beside < 0 || beside >= line.spans()) continue;
      sum += std::abs(highest(beside) - here);
      length += (line.width(span) + line.width(beside)) / 2;
    }
    if (length > 0) result[span] += s.weight * std::pow(sum / length, 2);
    weight[span] += s.weight;
  }
  for (int i = 0; i < line.spans(); ++i)
    if (weight[i] > 0) result[i] = std::sqrt(result[i] / weight[i]);
  return result;
}

/// Limits how much neighbouring densities differ.
void grade(std::vector<double>& density) {
  const double least = std::max(kNone, kLeastDensity * *std::max_element(density.begin(), density.end()));
  for (auto& d : density) d = std::max(d, least);
  for (std::size_t i = 1; i < density.size(); ++i)
    density[i] = std::max(density[i], density[i - 1] / kSteepest);
  for (std::size_t i = density.size() - 1; i-- > 0;)
    density[i] = std::max(density[i], density[i + 1] / kSteepest);
}

}  // namespace

KnotDemand demandOfBending(const SplineSurface& surface, const SplineSpace& space,
                           const std::vector<SurfaceSample>& samples, double deviation) {
  KnotDemand result;
  for (const int axis : {0, 1}) {
    const SplineLine& line = lineOf(space, axis);
    auto density = bendingAlong(axis, surface, space, samples);
    for (auto& d : density)
      d = std::pow(2 * kUnitDeviation[line.degree] * d / deviation, 1.0 / (line.degree + 1));
    grade(density);
    for (int i = 0; i < line.spans(); ++i) result[axis].push_back(density[i] * line.width(i));
  }
  return result;
}

void limitPoles(KnotDemand& demand, const SplineSpace& space, double poles) {
  double sum[2], more[2];
  for (const int axis : {0, 1}) {
    sum[axis] = std::accumulate(demand[axis].begin(), demand[axis].end(), 0.0);
    more[axis] = lineOf(space, axis).closed ? 0 : lineOf(space, axis).degree;
  }
  // (factor * sum[0] + more[0]) * (factor * sum[1] + more[1]) = poles
  const double a = sum[0] * sum[1], b = sum[0] * more[1] + sum[1] * more[0], c = more[0] * more[1] - poles;
  if (a + b + c <= 0) return;
  const double factor = c < 0 ? -2 * c / (b + std::sqrt(b * b - 4 * a * c)) : kNone;
  for (auto& line : demand)
    for (auto& d : line) d *= factor;
}

KnotDemand demandOfResidual(const SplineSpace& space, const std::vector<SurfaceSample>& samples,
                            const std::vector<std::array<int, 3>>& cells, double deviation, double least) {
  const auto variation = residualVariation(space, samples, cells);
  KnotDemand result{std::vector<double>(space.u.spans(), least), std::vector<double>(space.v.spans(), least)};
  for (const auto& s : samples) {
    const int i = space.u.spanOf(s.parameter[0]), j = space.v.spanOf(s.parameter[1]);
    const auto takesPart = directionsTakingPart(variation[i + std::size_t(space.u.spans()) * j]);
    const double part = std::abs(s.distance) / deviation;
    for (const int axis : {0, 1}) {
      if (!takesPart[axis] && part > 1) continue;
      double& demand = result[axis][axis == 0 ? i : j];
      demand = std::max(demand, std::pow(part, 1.0 / (lineOf(space, axis).degree + 1)));
    }
  }
  return result;
}

SplineLine respaced(const SplineLine& line, const std::vector<double>& demand) {
  const double sum = std::accumulate(demand.begin(), demand.end(), 0.0);
  const int spans = std::max(line.closed ? line.degree + 1 : 1, int(std::ceil(sum - 1e-6)));
  SplineLine result{line.degree, line.closed, {line.breaks.front()}};
  const double length = line.breaks.back() - line.breaks.front();
  double before = 0;
  for (int i = 0; i < line.spans(); ++i) {
    const double here = demand[i] / sum * spans;
    const double grain =
        std::exp2(std::floor(std::log2(std::min(line.width(i) / here, length / spans) / 32)));
    while (int(result.breaks.size()) < spans && before + here >= double(result.breaks.size())) {
      const double at = line.breaks[i] + line.width(i) * (double(result.breaks.size()) - before) / here;
      result.breaks.push_back(grain * std::round(at / grain));
    }
    before += here;
  }
  result.breaks.push_back(line.breaks.back());
  return result;
}

}  // namespace trimquad
