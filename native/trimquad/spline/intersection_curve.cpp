#include "trimquad/spline/intersection_curve.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

using Parameters = IntersectionCurve::Parameters;

/// Rows: SA - SB = 0, (SA - R) . direction = 0.
Eigen::Matrix4d jacobian(const SplineSurface::Jet& a, const SplineSurface::Jet& b,
                         const Eigen::Vector3d& direction) {
  Eigen::Matrix4d m;
  m << a.su, a.sv, -b.su, -b.sv, direction.dot(a.su), direction.dot(a.sv), 0, 0;
  return m;
}

/// Sine of the angle between the sheets.
double crossingAngle(const SplineSurface::Jet& a, const SplineSurface::Jet& b) {
  return a.su.cross(a.sv).normalized().cross(b.su.cross(b.sv).normalized()).norm();
}

}  // namespace

IntersectionCurve::IntersectionCurve(const Sheet& a, const Sheet& b, SpaceCurve reference,
                                     std::vector<Guess> guesses, double reach, double smallestAngle)
    : a_(&a),
      b_(&b),
      reference_(std::move(reference)),
      guesses_(std::move(guesses)),
      reach_(reach),
      smallestAngle_(smallestAngle) {
  TRIMQUAD_ASSERT(guesses_.size() >= 2);
}

std::optional<Parameters> IntersectionCurve::parameters(double s) const {
  const auto next = std::clamp(
      std::lower_bound(guesses_.begin(), guesses_.end(), s, [](const Guess& g, double x) { return g.s < x; }),
      guesses_.begin() + 1, guesses_.end() - 1);
  const Guess &low = *(next - 1), &high = *next;
  const double x = std::clamp((s - low.s) / (high.s - low.s), 0.0, 1.0);
  Parameters z = (1 - x) * low.at + x * high.at;

  const auto r = reference_.derivatives(s, 1);
  const Eigen::Vector3d direction = r[1].normalized();
  constexpr int maxSteps = 30;
  constexpr double converged = 1e-13;
  for (int step = 0; step < maxSteps; ++step) {
    const auto a = a_->jet(z.head<2>()), b = b_->jet(z.tail<2>());
    if (crossingAngle(a, b) < smallestAngle_) return {};
    Eigen::Vector4d f;
    f << a.s - b.s, direction.dot(a.s - r[0]);
    const Eigen::Vector4d move = jacobian(a, b, direction).partialPivLu().solve(-f);
    if (!move.allFinite()) return {};
    z += move;
    if (!a_->holds(z.head<2>()) || !b_->holds(z.tail<2>())) return {};
    if (move.cwiseAbs().maxCoeff() > converged * std::max(1.0, z.cwiseAbs().maxCoeff())) continue;
    if ((a.s - r[0]).norm() > reach_) return {};
    return z;
  }
  // Rounding keeps the last steps from vanishing where the model is far from the origin.
  const Eigen::Vector3d pa = a_->jet(z.head<2>()).s, pb = b_->jet(z.tail<2>()).s;
  if ((pa - pb).norm() > 1e-13 * std::max(1.0, pa.norm()) || (pa - r[0]).norm() > reach_) return {};
  return z;
}

CurveJet<7> IntersectionCurve::jet(double s) const {
  const auto solution = parameters(s);
  if (!solution) throw Missing{};
  const Parameters& z = *solution;
  const auto r = reference_.derivatives(s, 3);
  const auto a = a_->jet(z.head<2>()), b = b_->jet(z.tail<2>());
  const auto lu = jacobian(a, b, r[1]).partialPivLu();
  const Eigen::Vector3d away = a.s - r[0];

  Eigen::Vector4d rhs(0, 0, 0, r[1].dot(r[1]) - away.dot(r[2]));
  const Parameters z1 = lu.solve(rhs);
  const auto second = [](const SplineSurface::Jet& jet, double u, double v) -> Eigen::Vector3d {
    return jet.suu * (u * u) + jet.suv * (2 * u * v) + jet.svv * (v * v);
  };
  const Eigen::Vector3d a1 = a.su * z1[0] + a.sv * z1[1];
  const Eigen::Vector3d bendA = second(a, z1[0], z1[1]), bendB = second(b, z1[2], z1[3]);
  rhs << bendB - bendA, -(bendA.dot(r[1]) + 2 * a1.dot(r[2]) - 3 * r[1].dot(r[2]) + away.dot(r[3]));
  const Parameters z2 = lu.solve(rhs);

  CurveJet<7> jet;
  jet.value << z, a.s;
  jet.first << z1, a1;
  jet.second << z2, Eigen::Vector3d(bendA + a.su * z2[0] + a.sv * z2[1]);
  return jet;
}

double IntersectionCurve::parameterOf(const Eigen::Vector3d& p, double guess) const {
  double s = guess;
  constexpr int maxSteps = 30;
  for (int step = 0; step < maxSteps; ++step) {
    const auto r = reference_.derivatives(s, 2);
    const double slope = -r[1].squaredNorm() + (p - r[0]).dot(r[2]);
    if (!(slope < 0)) break;
    const double move = -(p - r[0]).dot(r[1]) / slope;
    s += move;
    if (std::abs(move) < 1e-15 * (reference_.last() - reference_.first())) break;
  }
  return s;
}

}  // namespace trimquad
