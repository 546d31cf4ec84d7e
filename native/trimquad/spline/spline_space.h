#pragma once

#include <Eigen/SparseCore>
#include <array>
#include <optional>
#include <vector>

#include "trimquad/base/progress.h"
#include "trimquad/spline/spline_geometry.h"

namespace trimquad {

class SlidingData;

/// The splines of one variable with simple knots at `breaks`: over an interval, or closed with their span as
/// period.
struct SplineLine {
  int degree = 3;
  bool closed = false;
  std::vector<double> breaks;  ///< increasing; both ends of the domain included

  int spans() const { return int(breaks.size()) - 1; }
  int unknowns() const { return closed ? spans() : spans() + degree; }
  double width(int span) const { return breaks[span + 1] - breaks[span]; }
  /// The span that holds t; of the nearest end for t outside.
  int spanOf(double t) const;
  /// Clamped knots; for closed splines the knots continue periodically, function i and i + unknowns() are
  /// one.
  std::vector<double> knots() const;
};

/// Integral over one span of the products of the k-th derivatives of its functions, for k = 0, 1, 2. Exact.
std::array<Eigen::MatrixXd, 3> spanProducts(const SplineLine& line, const std::vector<double>& knots,
                                            int span);

/// A point that the surface is to pass at a given parameter.
struct Datum {
  Eigen::Vector2d parameter;
  Eigen::Vector3d point;
  double weight;  ///< area of the parameter plane that it stands for, quads^2
  /// Projects onto the directions in which the surface may slide along the point.
  Eigen::Matrix3d free = Eigen::Matrix3d::Zero();
};

/// Weights of the thin-plate energy, relative to an integral of squared distance over the parameter plane.
/// Times the square of a knot rectangle's area where that is below 1 quad^2.
struct Fairness {
  double withData = 0, withoutData = 0;  ///< on knot rectangles that hold data, and on the others
  /// Knot rectangles that come that near to one of these count as larger ones do.
  struct StiffPlace {
    Eigen::Vector2d at;
    double reach;  ///< quads
  };
  std::vector<StiffPlace> stiff = {};
  /// On a knot rectangle that such a square touches the weight is at least its factor times `withData`.
  struct Spot {
    int chart;
    Eigen::Vector2d at;
    double reach;  ///< quads, in both directions
    double factor;
  };
  std::vector<Spot> spots = {};
  /// By chart and knot rectangle, (i, j) at i + u.spans() * j: factor of the weight. Empty: none.
  std::vector<std::vector<double>> stiffness = {};

  /// What concerns one chart, as its chart 0.
  Fairness ofChart(int chart) const;
  /// Weight of the energy on a knot rectangle.
  double weight(const SplineLine& u, int i, const SplineLine& v, int j, bool hasData) const;
  bool isStiff(const SplineLine& u, int i, const SplineLine& v, int j) const;
};

/// Tensor-product splines over a rectangle of the parameter plane.
struct SplineSpace {
  SplineLine u, v;

  int poles() const { return u.unknowns() * v.unknowns(); }
  /// A surface over its knots, without poles.
  SplineSurface emptySurface() const;

  /// The spline surface that minimises sum weight |S - point|^2 + fairness * integral of Suu^2 + 2 Suv^2 +
  /// Svv^2, where little of the distance counts along the directions in which a datum is free. Closed splines
  /// come out clamped, with end columns of poles that are equal bit by bit. Empty where the data and the
  /// fairness do not determine it.
  std::optional<SplineSurface> leastSquares(const std::vector<Datum>& data, const Fairness& fairness,
                                            const Progress& progress) const;

  /// Adds the normal equations of the same minimisation to the lower triangle of a larger system, in which
  /// unknown (i, j) has the number offset + i + u.unknowns() * j. Not for closed splines.
  /// \param middle of the points, which the right-hand side is relative to
  void addNormalEquations(const std::vector<Datum>& data, const Fairness& fairness,
                          const Eigen::Vector3d& middle, int offset,
                          std::vector<Eigen::Triplet<double>>& entries, Eigen::MatrixXd& rhs) const;

 private:
  template <class Number>
  void addSliding(const std::vector<Datum>& data, const Eigen::Vector3d& middle, const Number& number,
                  SlidingData& sliding) const;
  template <class Emit>
  void forEachRectangle(const std::vector<Datum>& data, const Fairness& fairness,
                        const Eigen::Vector3d& middle, const Progress* progress, const Emit& emit) const;
};

}  // namespace trimquad
