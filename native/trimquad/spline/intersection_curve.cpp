#include "trimquad/spline/intersection_curve.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

using Parameters = IntersectionCurve::Parameters;

/// From 0 to 1, without first and second derivatives at both ends; with derivatives by x.
std::array<double, 3> smootherStep(double x) {
  if (!(x > 0)) return {0, 0, 0};
  if (!(x < 1)) return {1, 0, 0};
  return {x * x * x * (10 + x * (6 * x - 15)), 30 * x * x * (1 - x) * (1 - x),
          60 * x * (1 - x) * (1 - 2 * x)};
}

}  // namespace

double crossingAngle(const SplineSurface::Jet& a, const SplineSurface::Jet& b) {
  return normal(a).cross(normal(b)).norm();
}

IntersectionCurve::IntersectionCurve(const Sheet& a, const Sheet& b, SpaceCurve reference,
                                     std::vector<Guess> guesses, double reach, double smallestAngle,
                                     const std::vector<TangentStretch>& tangent)
    : a_(&a),
      b_(&b),
      reference_(std::move(reference)),
      guesses_(std::move(guesses)),
      reach_(reach),
      smallestAngle_(smallestAngle) {
  TRIMQUAD_ASSERT(guesses_.size() >= 2);
  for (const auto& stretch : tangent) {
    const double ends[] = {stretch.first - stretch.blend, stretch.last + stretch.blend};
    const auto jetOfA = [&](double s) { return a_->jet(guessAt(s).head<2>()); };
    const Eigen::Vector3d n = normal(jetOfA((stretch.first + stretch.last) / 2));
    std::array<double, 2> slope;
    for (const int k : {0, 1}) {
      const auto at = guessAt(ends[k]);
      const Eigen::Vector3d across = reference_.derivatives(ends[k], 1)[1].cross(n);
      const auto rise = [&](const SplineSurface::Jet& jet) {
        const Eigen::Vector3d m = normal(jet);
        return -m.dot(across) / m.dot(n);
      };
      slope[k] = rise(a_->jet(at.head<2>())) - rise(b_->jet(at.tail<2>()));
    }
    // Of what lies beyond the curve only the other side counts.
    if (ends[0] < guesses_.front().s) slope[0] = slope[1];
    if (ends[1] > guesses_.back().s) slope[1] = slope[0];
    stretches_.push_back({stretch, n, slope});
    tangentEnds_.insert(tangentEnds_.end(), {ends[0], stretch.first, stretch.last, ends[1]});
  }
}

Parameters IntersectionCurve::guessAt(double s) const {
  const auto next = std::clamp(
      std::lower_bound(guesses_.begin(), guesses_.end(), s, [](const Guess& g, double x) { return g.s < x; }),
      guesses_.begin() + 1, guesses_.end() - 1);
  const Guess &low = *(next - 1), &high = *next;
  const double x = std::clamp((s - low.s) / (high.s - low.s), 0.0, 1.0);
  return (1 - x) * low.at + x * high.at;
}

const IntersectionCurve::Stretch* IntersectionCurve::stretchAt(double s) const {
  for (const auto& stretch : stretches_)
    if (s > stretch.first - stretch.blend && s < stretch.last + stretch.blend) return &stretch;
  return nullptr;
}

/// \param r the reference with three derivatives
IntersectionCurve::Equations IntersectionCurve::equations(double s,
                                                          const std::vector<Eigen::Vector3d>& r) const {
  Equations result;
  for (int k = 0; k < 3; ++k) {
    result.q[k].setZero();
    result.p[k].setZero();
    result.p[k].row(3) = r[k + 1];
  }
  const Stretch* stretch = stretchAt(s);
  if (!stretch) {
    result.q[0].topRows<3>().setIdentity();
    return result;
  }
  const bool after = s > (stretch->first + stretch->last) / 2;
  const double away = after ? s - stretch->last : stretch->first - s, sign = after ? 1 : -1;
  const auto step = smootherStep(away / stretch->blend);
  const double edge[] = {step[0], sign * step[1] / stretch->blend,
                         step[2] / (stretch->blend * stretch->blend)};
  const Eigen::Vector3d& n = stretch->normal;
  Eigen::Vector3d across[3];
  for (int k = 0; k < 3; ++k) {
    result.q[k].row(0) = r[k + 1];
    across[k] = r[k + 1].cross(n);
    result.q[k].row(1) = across[k];
    result.q[k].row(2) = edge[k] * n;
  }
  const double slope = stretch->slope[after ? 1 : 0];
  result.p[0].row(2) = slope * (1 - edge[0]) * across[0];
  result.p[1].row(2) = slope * ((1 - edge[0]) * across[1] - edge[1] * across[0]);
  result.p[2].row(2) = slope * ((1 - edge[0]) * across[2] - 2 * edge[1] * across[1] - edge[2] * across[0]);
  return result;
}

Eigen::Vector4d IntersectionCurve::Equations::residual(const SplineSurface::Jet& a,
                                                       const SplineSurface::Jet& b,
                                                       const Eigen::Vector3d& r) const {
  return q[0] * (a.s - b.s) + p[0] * (a.s - r);
}

Eigen::Matrix4d IntersectionCurve::Equations::jacobian(const SplineSurface::Jet& a,
                                                       const SplineSurface::Jet& b) const {
  const Eigen::Matrix<double, 4, 3> both = q[0] + p[0];
  Eigen::Matrix4d m;
  m << both * a.su, both * a.sv, -q[0] * b.su, -q[0] * b.sv;
  return m;
}

std::optional<Parameters> IntersectionCurve::parameters(double s) const {
  Parameters z = guessAt(s);
  const auto r = reference_.derivatives(s, 3);
  const Equations equations = this->equations(s, r);
  const bool touches = stretchAt(s);
  constexpr int maxSteps = 30;
  constexpr double converged = 1e-13;
  for (int step = 0; step < maxSteps; ++step) {
    const auto a = a_->jet(z.head<2>()), b = b_->jet(z.tail<2>());
    if (!touches && crossingAngle(a, b) < smallestAngle_) return {};
    const Parameters move = equations.jacobian(a, b).partialPivLu().solve(-equations.residual(a, b, r[0]));
    if (!move.allFinite()) return {};
    z += move;
    if (!a_->holds(z.head<2>()) || !b_->holds(z.tail<2>())) return {};
    if (move.cwiseAbs().maxCoeff() > converged * std::max(1.0, z.cwiseAbs().maxCoeff())) continue;
    if ((a.s - r[0]).norm() > reach_) return {};
    return z;
  }
  // Rounding keeps the last steps from vanishing where the model is far from the origin.
  const auto a = a_->jet(z.head<2>()), b = b_->jet(z.tail<2>());
  const double off = touches ? equations.residual(a, b, r[0]).norm() : (a.s - b.s).norm();
  if (off > 1e-13 * std::max(1.0, a.s.norm()) || (a.s - r[0]).norm() > reach_) return {};
  return z;
}

double IntersectionCurve::apart(double s) const {
  if (!stretchAt(s)) return 0;
  const auto z = parameters(s);
  if (!z) throw Missing{};
  return (a_->jet(z->head<2>()).s - b_->jet(z->tail<2>()).s).norm();
}

CurveJet<7> IntersectionCurve::jet(double s) const {
  const auto solution = parameters(s);
  if (!solution) throw Missing{};
  const Parameters& z = *solution;
  const auto r = reference_.derivatives(s, 3);
  const Equations equations = this->equations(s, r);
  const auto a = a_->jet(z.head<2>()), b = b_->jet(z.tail<2>());
  const auto lu = equations.jacobian(a, b).partialPivLu();
  const auto &q = equations.q, &p = equations.p;
  const Eigen::Vector3d apart = a.s - b.s, away = a.s - r[0];

  const Parameters z1 = lu.solve(p[0] * r[1] - q[1] * apart - p[1] * away);
  const auto second = [](const SplineSurface::Jet& jet, double u, double v) -> Eigen::Vector3d {
    return jet.suu * (u * u) + jet.suv * (2 * u * v) + jet.svv * (v * v);
  };
  const Eigen::Vector3d a1 = a.su * z1[0] + a.sv * z1[1], b1 = b.su * z1[2] + b.sv * z1[3];
  const Eigen::Vector3d bendA = second(a, z1[0], z1[1]), bendB = second(b, z1[2], z1[3]);
  const Parameters z2 = lu.solve(-(q[2] * apart + 2 * q[1] * (a1 - b1) + q[0] * (bendA - bendB) +
                                   p[2] * away + 2 * p[1] * (a1 - r[1]) + p[0] * (bendA - r[2])));

  CurveJet<7> jet;
  jet.value << z, a.s;
  jet.first << z1, a1;
  jet.second << z2, Eigen::Vector3d(bendA + a.su * z2[0] + a.sv * z2[1]);
  return jet;
}

double IntersectionCurve::parameterOf(const Eigen::Vector3d& p, double guess) const {
  return nearestParameter(reference_, p, guess);
}

}  // namespace trimquad
