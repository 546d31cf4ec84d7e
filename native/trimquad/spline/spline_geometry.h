#pragma once

#include <Eigen/Geometry>
#include <array>
#include <span>
#include <vector>

namespace trimquad {

/// Largest degree of any curve or surface.
inline constexpr int kMaxSplineDegree = 15;

/// The basis functions that do not vanish on one knot span, with derivatives. (Piegl & Tiller, The NURBS
/// Book, A2.3)
struct BasisFunctions {
  int first = 0;  ///< index of the first one
  /// value[k][j]: k-th derivative of function first + j, for j <= degree.
  std::array<std::array<double, kMaxSplineDegree + 1>, kMaxSplineDegree + 1> value;
};

/// Index i with knots[i] <= t < knots[i + 1] and degree <= i < count, where count = knots.size() - degree -
/// 1; t outside belongs to the nearest span.
int knotSpan(std::span<const double> knots, int degree, double t);

/// The basis functions at `t` and their derivatives up to `order` (zero above the degree; only [0, order] is
/// written). Outside the domain the polynomials of the end spans continue. Does not allocate.
void basisFunctions(std::span<const double> knots, int degree, double t, int order, BasisFunctions& result);

/// The polar form of the polynomials of the knot span that holds `at`, evaluated at `arguments`, as many as
/// the degree, in any order: a spline's value there is the sum of weight[j] * pole[first + j]. With
/// consecutive knots of a finer spline as arguments it is that one's pole. (Ramshaw) Returns first; writes
/// degree + 1 weights.
int polarForm(std::span<const double> knots, int degree, double at, std::span<const double> arguments,
              std::span<double> weight);

/// A B-spline curve in dimension `Dim`, with a clamped, flat knot vector (each knot repeated by its
/// multiplicity; knots.size() == poles.size() + degree + 1). Not rational.
template <int Dim>
struct SplineCurve {
  using Point = Eigen::Matrix<double, Dim, 1>;
  int degree = 3;
  std::vector<double> knots;
  std::vector<Point> poles;

  double first() const { return knots[degree]; }
  double last() const { return knots[poles.size()]; }
  Point point(double t) const { return derivatives(t, 0)[0]; }
  /// Value and derivatives up to `order`. Outside the domain the polynomials of the end spans continue.
  std::vector<Point> derivatives(double t, int order) const;
};

/// The same curve with `t`, inside the domain, as an additional knot, `times` times. (Boehm)
template <int Dim>
SplineCurve<Dim> withKnot(SplineCurve<Dim> curve, double t, int times = 1);

/// The piece of the curve over [a, b] inside its domain, with the same parameter.
template <int Dim>
SplineCurve<Dim> restricted(const SplineCurve<Dim>& curve, double a, double b);

using PlaneCurve = SplineCurve<2>;
using SpaceCurve = SplineCurve<3>;

/// A tensor-product B-spline surface over [firstU, lastU] x [firstV, lastV], clamped flat knots, not
/// rational. Parameters are the grid coordinates of the region's chart, in quads. Normal = Su x Sv points
/// outward.
struct SplineSurface {
  int degreeU = 3, degreeV = 3;
  std::vector<double> knotsU, knotsV;
  int countU = 0, countV = 0;
  std::vector<Eigen::Vector3d> poles;  ///< pole (i, j) at i + countU * j
  /// Whether S(firstU, v) == S(lastU, v) with all derivatives up to order degreeU - 1 (poles of both end
  /// columns are equal bit by bit).
  bool closedU = false;

  // Evaluation outside the domain continues the polynomials of the end spans; it does not wrap around.

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

  /// All partial derivatives up to `order` in each direction: k-th in u and l-th in v at k + (order + 1) * l.
  std::vector<Eigen::Vector3d> derivatives(double u, double v, int order) const;

  /// `u` moved by periods into [firstU, lastU) where the surface is closed in u; unchanged where not.
  double wrappedU(double u) const;

  /// Parameters of the point closest to `p` among those reached from `guess` by damped Newton steps, kept
  /// inside the domain (wrapping around where the surface is closed in u: u is in [firstU, lastU)).
  /// \param step smallest last step, relative to the parameters; 1e-6 leaves the distance exact up to
  /// rounding
  Eigen::Vector2d footPoint(const Eigen::Vector3d& p, const Eigen::Vector2d& guess,
                            double step = 1e-15) const;
  /// The same inside a part of the domain, which may be a segment of a line u or v = const; not for closed
  /// surfaces.
  Eigen::Vector2d footPoint(const Eigen::Vector3d& p, const Eigen::Vector2d& guess,
                            const Eigen::AlignedBox2d& part, double step) const;

  /// The exact curve v -> S(u, v).
  SpaceCurve curveAtU(double u) const;
  /// The exact curve u -> S(u, v).
  SpaceCurve curveAtV(double v) const;
};

/// The curve's parameter at which it is nearest to `p`, by Newton steps from `guess`; it may lie outside the
/// domain, where the polynomials of the end spans continue.
double nearestParameter(const SpaceCurve& curve, const Eigen::Vector3d& p, double guess);

/// The same surface with an additional knot, `times` times.
SplineSurface withKnotU(const SplineSurface& surface, double u, int times = 1);
SplineSurface withKnotV(const SplineSurface& surface, double v, int times = 1);

/// The piece of the surface over a part of its domain, with the same parameters; open in u where that is not
/// all of it.
SplineSurface restricted(const SplineSurface& surface, const Eigen::AlignedBox2d& part);

}  // namespace trimquad
