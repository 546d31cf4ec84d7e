#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "trimquad/spline/spline_geometry.h"

namespace trimquad {

/// A fitted surface to be trimmed. Where it is closed in u, parameters run on over the seam (they are
/// unwrapped), so that curves across it are continuous.
struct Sheet {
  SplineSurface surface;
  std::optional<double> period;  ///< of u, in quads
  /// How far beyond its domain the surface may be evaluated on the way to a point on it (its polynomials go
  /// on there), quads: where it ends at a border with another sheet of the region.
  double slack = 0;

  SplineSurface::Jet jet(const Eigen::Vector2d& x) const;
  /// The foot point of `p` near `guess`, unwrapped.
  Eigen::Vector2d footPoint(const Eigen::Vector3d& p, const Eigen::Vector2d& guess) const;
  /// Whether the surface is defined at `x`.
  bool holds(const Eigen::Vector2d& x) const;
  /// Order up to which the surface is differentiable everywhere, at most 2.
  int continuity() const;
  /// Knots strictly between `low` and `high` on an axis (0: u, unwrapped; 1: v), ascending, each once.
  std::vector<double> knotLines(int axis, double low, double high) const;
};

/// The unit normal, on the side of su x sv.
Eigen::Vector3d normal(const SplineSurface::Jet& jet);

/// The way in the parameter plane that goes nearest to `way` on the surface.
Eigen::Vector2d inPlane(const SplineSurface::Jet& jet, const Eigen::Vector3d& way);

/// The same closed surface with its seam at `u` instead; exact. (knots inserted at the new seam, removed at
/// the old one, where the surface is C^(degree-1))
SplineSurface withSeamAt(const SplineSurface& closed, double u);

/// Parameters in (a, b) where the coordinate `x(s)` passes from one side of `level` to the other, leaving a
/// band of
/// +-`band` around it on both sides, ascending. Crossings closer together than (b - a) / steps may be missed.
std::vector<double> crossings(const std::function<double(double)>& x, double level, double band, double a,
                              double b, int steps);

/// Parameters in (a, b) where the plane curve `x(s)` crosses knot lines of the sheet. A curve that runs along
/// a knot line, leaving it by less than a thousandth of a quad, does not cross it: what that costs is of
/// third order.
std::vector<double> knotCrossings(const Sheet& sheet, const std::function<Eigen::Vector2d(double)>& x,
                                  double a, double b);

}  // namespace trimquad
