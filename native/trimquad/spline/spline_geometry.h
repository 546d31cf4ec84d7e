#pragma once

#include <Eigen/Core>
#include <vector>

namespace trimquad {

/// A B-spline curve in dimension `Dim`, with a clamped, flat knot vector (each knot repeated by its multiplicity;
/// knots.size() == poles.size() + degree + 1). Not rational.
template <int Dim>
struct SplineCurve {
  using Point = Eigen::Matrix<double, Dim, 1>;
  int degree = 3;
  std::vector<double> knots;
  std::vector<Point> poles;

  double first() const { return knots[degree]; }
  double last() const { return knots[poles.size()]; }
  Point point(double t) const { return derivatives(t, 0)[0]; }
  /// Value and derivatives up to `order`.
  std::vector<Point> derivatives(double t, int order) const;
};

using PlaneCurve = SplineCurve<2>;
using SpaceCurve = SplineCurve<3>;

/// A tensor-product B-spline surface over [firstU, lastU] x [firstV, lastV], clamped flat knots, not rational.
/// Parameters are the grid coordinates of the region's chart, in quads. Normal = Su x Sv points outward.
struct SplineSurface {
  int degreeU = 3, degreeV = 3;
  std::vector<double> knotsU, knotsV;
  int countU = 0, countV = 0;
  std::vector<Eigen::Vector3d> poles;  ///< pole (i, j) at i + countU * j
  /// Whether S(firstU, v) == S(lastU, v) with all derivatives up to order degreeU - 1 (poles of both end columns are
  /// equal bit by bit).
  bool closedU = false;

  const Eigen::Vector3d& pole(int i, int j) const { return poles[i + countU * j]; }
  double firstU() const { return knotsU[degreeU]; }
  double lastU() const { return knotsU[countU]; }
  double firstV() const { return knotsV[degreeV]; }
  double lastV() const { return knotsV[countV]; }

  Eigen::Vector3d point(double u, double v) const;

  struct Jet {  ///< value and partial derivatives up to second order
    Eigen::Vector3d s, su, sv, suu, suv, svv;
  };
  Jet jet(double u, double v) const;

  /// Parameters of the point closest to `p`, by Newton from `guess`, kept inside the domain (wrapping around where the
  /// surface is closed in u).
  Eigen::Vector2d footPoint(const Eigen::Vector3d& p, Eigen::Vector2d guess) const;
};

}  // namespace trimquad
