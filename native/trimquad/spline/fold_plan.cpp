#include "trimquad/spline/fold_plan.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace trimquad {
namespace {

/// Sine of the angle from which on sheets stay a ridge, or a valley, as they are.
constexpr double kDecided = 0.25;
/// Half of the length of a tangent stretch around a place, quads; and by the curve's length at most.
constexpr double kStretch = 0.125, kMostStretch = 0.125;

/// By sample.
std::vector<double> angles(const SampledCurve& sampled, const std::array<const Sheet*, 2>& sheets,
                           bool firstOnLeft) {
  std::vector<double> found;
  const std::size_t last = sampled.s.size() - 1;
  for (std::size_t i = 0; i <= last; ++i) {
    Eigen::Vector3d n[2];
    for (const int k : {0, 1})
      n[k] = normal(sheets[k]->jet(sheets[k]->footPoint(sampled.point[i], sampled.foot[k][i])));
    const Eigen::Vector3d way =
        (sampled.point[std::min(i + 1, last)] - sampled.point[i == 0 ? 0 : i - 1]).normalized();
    const double sine = (firstOnLeft ? 1 : -1) * n[0].cross(n[1]).dot(way);
    found.push_back(n[0].dot(n[1]) > 0 ? sine : std::copysign(HUGE_VAL, sine));
  }
  return found;
}

/// 1 where less turning makes the sheets a ridge than a valley, else -1.
double lessTurning(const std::vector<double>& angle) {
  double ridge = 0, valley = 0;
  for (const double a : angle) {
    ridge += std::max(0.0, kFold - a);
    valley += std::max(0.0, kFold + a);
  }
  return ridge <= valley ? 1 : -1;
}

/// What the sheets are to make, by sample: the same all along, unless they clearly make both.
std::vector<double> kinds(const std::vector<double>& angle) {
  std::vector<std::size_t> decided;
  for (std::size_t i = 0; i < angle.size(); ++i)
    if (std::abs(angle[i]) > kDecided) decided.push_back(i);
  if (decided.empty()) return std::vector<double>(angle.size(), lessTurning(angle));
  std::vector<double> kind(angle.size(), std::copysign(1, angle[decided.front()]));
  for (std::size_t k = 0; k + 1 < decided.size(); ++k) {
    const std::size_t i = decided[k], j = decided[k + 1];
    if ((angle[i] > 0) == (angle[j] > 0)) continue;
    const auto change = std::min_element(angle.begin() + long(i), angle.begin() + long(j),
                                         [](double a, double b) { return std::abs(a) < std::abs(b); });
    std::fill(kind.begin() + (change - angle.begin()), kind.end(), std::copysign(1, angle[j]));
  }
  return kind;
}

/// Length from the curve's start to each sample, quads of the first sheet.
std::vector<double> quadsAlong(const SampledCurve& sampled, const Sheet& sheet) {
  std::vector<double> result{0};
  for (std::size_t i = 0; i + 1 < sampled.s.size(); ++i) {
    const Eigen::Vector3d way = sampled.point[i + 1] - sampled.point[i];
    result.push_back(result.back() + inPlane(sheet.jet(sampled.foot[0][i]), way).norm());
  }
  return result;
}

}  // namespace

double smoothStep(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * (3 - 2 * x);
}

FoldPlan planFold(const SampledCurve& sampled, const std::array<const Sheet*, 2>& sheets, bool firstOnLeft,
                  const std::array<std::array<bool, 2>, 2>& fixed) {
  const std::size_t count = sampled.s.size();
  FoldPlan plan;
  plan.angle = angles(sampled, sheets, firstOnLeft);
  plan.kind = kinds(plan.angle);
  plan.level.assign(count, kFold);
  plan.near.assign(count, false);
  const auto along = quadsAlong(sampled, *sheets[0]);
  const double length = along.back(), half = std::min(kStretch, kMostStretch * length);
  for (const int side : {0, 1})
    for (std::size_t i = 0; i < count; ++i)
      plan.given[side].push_back((fixed[side][0] && along[i] < half) ||
                                 (fixed[side][1] && along[i] > length - half));

  std::vector<std::array<double, 2>> ranges;  // quads, with their blends
  // Sheets that cross steeply in a corner have an intersection there, whatever fixes their tangent planes.
  const auto touches = [](double angle) { return std::abs(angle) < kKept; };
  if ((fixed[0][0] || fixed[1][0]) && touches(plan.angle.front())) ranges.push_back({-half, 2 * half});
  for (std::size_t i = 0; i + 1 < count; ++i) {
    if ((plan.kind[i] > 0) == (plan.kind[i + 1] > 0)) continue;
    const double at = (along[i] + along[i + 1]) / 2;
    for (std::size_t k = 0; k < count; ++k)
      plan.level[k] = std::min(plan.level[k], kFold * smoothStep(std::abs(along[k] - at) / half));
    ranges.push_back({at - 2 * half, at + 2 * half});
  }
  if ((fixed[0][1] || fixed[1][1]) && touches(plan.angle.back()))
    ranges.push_back({length - 2 * half, length + half});

  std::sort(ranges.begin(), ranges.end());
  std::vector<std::array<double, 2>> merged;
  for (const auto& range : ranges) {
    if (!merged.empty() && range[0] <= merged.back()[1])
      merged.back()[1] = std::max(merged.back()[1], range[1]);
    else
      merged.push_back(range);
  }
  const auto chordLengthAt = [&](double quads) {
    const double beyond = (sampled.s.back() - sampled.s.front()) / length;
    if (quads <= 0) return sampled.s.front() + beyond * quads;
    if (quads >= length) return sampled.s.back() + beyond * (quads - length);
    const auto next =
        std::clamp(std::lower_bound(along.begin(), along.end(), quads), along.begin() + 1, along.end() - 1);
    const std::size_t i = next - along.begin() - 1;
    const double x = (quads - along[i]) / (along[i + 1] - along[i]);
    return sampled.s[i] + x * (sampled.s[i + 1] - sampled.s[i]);
  };
  for (const auto& range : merged) {
    const double from = chordLengthAt(range[0]), to = chordLengthAt(range[1]);
    const double blend = half * (to - from) / (range[1] - range[0]);
    plan.tangent.push_back({from + blend, to - blend, blend});
    for (std::size_t i = 0; i < count; ++i)
      if (sampled.s[i] >= from && sampled.s[i] <= to) plan.near[i] = true;
  }
  return plan;
}

SampledCurve denserWhereTangent(const SampledCurve& sampled, const FoldPlan& plan, const Sheet& first,
                                double step) {
  SampledCurve result{sampled.curve, {}, {}, {}, std::vector<std::vector<Eigen::Vector2d>>(2)};
  const auto along = quadsAlong(sampled, first);
  for (std::size_t i = 0; i < sampled.s.size(); ++i) {
    const bool divided = i + 1 < sampled.s.size() && plan.near[i] && plan.near[i + 1];
    const int parts = divided ? std::max(1, int(std::ceil((along[i + 1] - along[i]) / step))) : 1;
    for (int k = 0; k < parts; ++k) {
      const double x = double(k) / parts;
      const auto between = [&](const auto& values) -> std::decay_t<decltype(values[0])> {
        if (k == 0) return values[i];
        return (1 - x) * values[i] + x * values[i + 1];
      };
      result.t.push_back(between(sampled.t));
      result.s.push_back(between(sampled.s));
      result.point.push_back(k == 0 ? sampled.point[i] : sampled.curve->curve->point(result.t.back()));
      for (const int side : {0, 1}) result.foot[side].push_back(between(sampled.foot[side]));
    }
  }
  return result;
}

}  // namespace trimquad
