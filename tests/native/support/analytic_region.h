#pragma once

#include <cmath>
#include <functional>
#include <memory>

#include "trimquad/gridmap/grid_map.h"
#include "trimquad/mesh/region.h"

namespace trimquad {

/// A region over a grid of the plane and its grid map, from formulas.
struct AnalyticRegion {
  int columns = 10, rows = 10;                            ///< cells of the triangulated grid
  double firstU = 0, lastU = 10, firstV = 0, lastV = 10;  ///< quads
  bool closed = false;                                    ///< the last column meets the first
  std::function<Eigen::Vector3d(double, double)> point;
  std::function<bool(double, double)> keeps = [](double, double) { return true; };  ///< by cell centre
  /// What the map says instead of (u, v). Leaves distances around a closed grid as they are.
  std::function<Eigen::Vector2d(double, double)> chart = [](double u, double v) {
    return Eigen::Vector2d(u, v);
  };
  int turn = 0;  ///< quarter turns of the whole chart
  std::shared_ptr<const TrueSurface> surface;

  Region region;
  GridMap map;

  void build();
};

/// The graph z = f(x, y).
class GraphSurface : public TrueSurface {
 public:
  using Height = std::function<Eigen::Vector3d(double, double)>;  ///< f, df/dx, df/dy
  explicit GraphSurface(Height height) : height_(std::move(height)) {}

  Foot closest(const Eigen::Vector3d& p) const override {
    // Alternating projection onto the tangent plane: converges where the curvature times the distance is
    // small.
    double x = p.x(), y = p.y();
    for (int step = 0; step < 60; ++step) {
      const Eigen::Vector3d f = height_(x, y);
      const Eigen::Vector3d n = Eigen::Vector3d(-f.y(), -f.z(), 1).normalized();
      const Eigen::Vector3d q = p - n * (p - Eigen::Vector3d(x, y, f.x())).dot(n);
      const double move = std::hypot(q.x() - x, q.y() - y);
      x = q.x();
      y = q.y();
      if (move < 1e-14) break;
    }
    const Eigen::Vector3d f = height_(x, y);
    return {{x, y, f.x()}, Eigen::Vector3d(-f.y(), -f.z(), 1).normalized()};
  }
  Foot closestFacing(const Eigen::Vector3d& p, const Eigen::Vector3d&) const override { return closest(p); }
  Curvature curvature(const Eigen::Vector3d&) const override { return {}; }

 private:
  Height height_;
};

/// sin x cos y and its derivatives.
Eigen::Vector3d wave(double x, double y);

/// z = wave(x, y) around the origin, 100 x 100 points, mapped onto the square of the two coordinates; not
/// built.
AnalyticRegion wavySheet(double first, double last, double quadsPerUnit);

class SphereSurface : public TrueSurface {
 public:
  explicit SphereSurface(double radius) : radius_(radius) {}
  Foot closest(const Eigen::Vector3d& p) const override { return {radius_ * p.normalized(), p.normalized()}; }
  Foot closestFacing(const Eigen::Vector3d& p, const Eigen::Vector3d&) const override { return closest(p); }
  Curvature curvature(const Eigen::Vector3d&) const override { return {}; }

 private:
  double radius_;
};

}  // namespace trimquad
