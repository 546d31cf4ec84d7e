#include "trimquad/mesh/polyline_curve.h"

#include <algorithm>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

/// How far from the guess the closest point is looked for, relative to the distance at the guess.
constexpr double kReach = 3;

}  // namespace

PolylineCurve::PolylineCurve(std::vector<Eigen::Vector3d> points) : points_(std::move(points)) {
  if (points_.size() < 2) throw inputError("tessellate", "a curve needs two points");
  parameter_.push_back(0);
  for (std::size_t i = 1; i < points_.size(); ++i) {
    parameter_.push_back(parameter_.back() + (points_[i] - points_[i - 1]).norm());
    if (!(parameter_[i] > parameter_[i - 1]))
      throw inputError("tessellate", "two consecutive points of a boundary coincide", {}, points_[i]);
  }
}

int PolylineCurve::segmentAt(double t) const {
  const auto after = std::upper_bound(parameter_.begin(), parameter_.end(), t);
  return std::clamp(int(after - parameter_.begin()) - 1, 0, int(points_.size()) - 2);
}

Eigen::Vector3d PolylineCurve::point(double t) const {
  const int i = segmentAt(t);
  const double s = std::clamp((t - parameter_[i]) / (parameter_[i + 1] - parameter_[i]), 0.0, 1.0);
  return s == 1 ? points_[i + 1] : Eigen::Vector3d(points_[i] + s * (points_[i + 1] - points_[i]));
}

Eigen::Vector3d PolylineCurve::tangent(double t) const {
  const int i = segmentAt(t);
  return (points_[i + 1] - points_[i]).normalized();
}

double PolylineCurve::closest(const Eigen::Vector3d& p, double guess) const {
  guess = std::clamp(guess, first(), last());
  const int segments = int(points_.size()) - 1, start = segmentAt(guess);
  double best = guess, bestSquare = (point(guess) - p).squaredNorm();
  const double reach = kReach * std::sqrt(bestSquare);
  const auto visit = [&](int i) {
    const Eigen::Vector3d d = points_[i + 1] - points_[i];
    const double s = std::clamp((p - points_[i]).dot(d) / d.squaredNorm(), 0.0, 1.0);
    const double square = (points_[i] + s * d - p).squaredNorm();
    if (square < bestSquare) {
      bestSquare = square;
      best = parameter_[i] + s * (parameter_[i + 1] - parameter_[i]);
    }
  };
  visit(start);
  for (const int step : {1, -1}) {
    double walked = step > 0 ? parameter_[start + 1] - guess : guess - parameter_[start];
    int i = start + step;
    for (int count = 1; count < segments && walked <= reach; ++count, i += step) {
      if (closed()) i = (i + segments) % segments;
      if (i < 0 || i >= segments) break;
      visit(i);
      walked += parameter_[i + 1] - parameter_[i];
    }
  }
  return best;
}

}  // namespace trimquad
