#include "trimquad/spline/spline_geometry.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

#include "trimquad/base/error.h"

namespace trimquad {

int knotSpan(std::span<const double> knots, int degree, double t) {
  const int count = int(knots.size()) - degree - 1;
  const auto begin = knots.begin() + degree + 1, end = knots.begin() + count;
  return int(std::upper_bound(begin, end, t) - knots.begin()) - 1;
}

namespace {

/// Any order. (Piegl & Tiller, The NURBS Book, A2.3)
void basisFunctionsOfAnyOrder(std::span<const double> knots, int degree, double t, int order,
                              BasisFunctions& result) {
  constexpr int size = kMaxSplineDegree + 1;
  const int span = knotSpan(knots, degree, t), computed = std::min(order, degree);
  result.first = span - degree;
  double table[size][size], left[size], right[size];
  table[0][0] = 1;
  for (int j = 1; j <= degree; ++j) {
    left[j] = t - knots[span + 1 - j];
    right[j] = knots[span + j] - t;
    double saved = 0;
    for (int r = 0; r < j; ++r) {
      table[j][r] = right[r + 1] + left[j - r];
      const double x = table[r][j - 1] / table[j][r];
      table[r][j] = saved + right[r + 1] * x;
      saved = left[j - r] * x;
    }
    table[j][j] = saved;
  }
  for (int j = 0; j <= degree; ++j) result.value[0][j] = table[j][degree];
  for (int r = 0; computed > 0 && r <= degree; ++r) {
    double a[2][size];
    int now = 0, next = 1;
    a[0][0] = 1;
    for (int k = 1; k <= computed; ++k) {
      double d = 0;
      const int rk = r - k, pk = degree - k;
      if (rk >= 0) {
        a[next][0] = a[now][0] / table[pk + 1][rk];
        d = a[next][0] * table[rk][pk];
      }
      const int from = rk >= -1 ? 1 : -rk, to = r - 1 <= pk ? k - 1 : degree - r;
      for (int j = from; j <= to; ++j) {
        a[next][j] = (a[now][j] - a[now][j - 1]) / table[pk + 1][rk + j];
        d += a[next][j] * table[rk + j][pk];
      }
      if (r <= pk) {
        a[next][k] = -a[now][k - 1] / table[pk + 1][r];
        d += a[next][k] * table[r][pk];
      }
      result.value[k][r] = d;
      std::swap(now, next);
    }
  }
  double factor = degree;
  for (int k = 1; k <= computed; ++k, factor *= degree - k + 1)
    for (int j = 0; j <= degree; ++j) result.value[k][j] *= factor;
  for (int k = computed + 1; k <= order; ++k)
    for (int j = 0; j <= degree; ++j) result.value[k][j] = 0;
}

/// The same up to second derivatives, where most of the time of a fit goes: a function's derivatives are
/// differences of those of the degrees below, which the recursion passes on its way.
template <int Degree, int Order>
void basisFunctionsOf(std::span<const double> knots, double t, BasisFunctions& result) {
  static_assert(Order <= 2 && Order <= Degree);
  const int span = knotSpan(knots, Degree, t);
  result.first = span - Degree;
  double left[Degree + 1], right[Degree + 1];
  double value[Degree + 1];  // of the functions of degree j
  double part[Degree + 1];   // those of degree j - 1 by the length of the interval on which they live
  double partBefore[Degree + 1], perLength[Degree + 1];
  value[0] = 1;
#pragma GCC unroll 8
  for (int j = 1; j <= Degree; ++j) {
    left[j] = t - knots[span + 1 - j];
    right[j] = knots[span + j] - t;
    if (Order == 2 && j == Degree) std::copy_n(part, Degree - 1, partBefore);
    double saved = 0;
#pragma GCC unroll 8
    for (int r = 0; r < j; ++r) {
      perLength[r] = 1 / (right[r + 1] + left[j - r]);
      part[r] = value[r] * perLength[r];
      value[r] = saved + right[r + 1] * part[r];
      saved = left[j - r] * part[r];
    }
    value[j] = saved;
  }
  for (int j = 0; j <= Degree; ++j) result.value[0][j] = value[j];
  if constexpr (Order >= 1) {
    result.value[1][0] = -Degree * part[0];
    for (int j = 1; j < Degree; ++j) result.value[1][j] = Degree * (part[j - 1] - part[j]);
    result.value[1][Degree] = Degree * part[Degree - 1];
  }
  if constexpr (Order == 2) {
    double slope[Degree];  // of the functions of degree Degree - 1, by Degree - 1 and their interval's length
    slope[0] = -partBefore[0] * perLength[0];
    for (int j = 1; j < Degree - 1; ++j) slope[j] = (partBefore[j - 1] - partBefore[j]) * perLength[j];
    slope[Degree - 1] = partBefore[Degree - 2] * perLength[Degree - 1];
    constexpr double factor = Degree * (Degree - 1);
    result.value[2][0] = -factor * slope[0];
    for (int j = 1; j < Degree; ++j) result.value[2][j] = factor * (slope[j - 1] - slope[j]);
    result.value[2][Degree] = factor * slope[Degree - 1];
  }
}

template <int Degree>
void basisFunctionsOfDegree(std::span<const double> knots, double t, int order, BasisFunctions& result) {
  switch (order) {
    case 0:
      return basisFunctionsOf<Degree, 0>(knots, t, result);
    case 1:
      return basisFunctionsOf<Degree, 1>(knots, t, result);
    case 2:
      return basisFunctionsOf<Degree, 2>(knots, t, result);
    default:
      return basisFunctionsOfAnyOrder(knots, Degree, t, order, result);
  }
}

}  // namespace

void basisFunctions(std::span<const double> knots, int degree, double t, int order, BasisFunctions& result) {
  TRIMQUAD_ASSERT(degree >= 1 && degree <= kMaxSplineDegree && order <= kMaxSplineDegree);
  switch (degree) {
    case 2:
      return basisFunctionsOfDegree<2>(knots, t, order, result);
    case 3:
      return basisFunctionsOfDegree<3>(knots, t, order, result);
    case 4:
      return basisFunctionsOfDegree<4>(knots, t, order, result);
    case 5:
      return basisFunctionsOfDegree<5>(knots, t, order, result);
    case 9:  // edges in space
      return basisFunctionsOfDegree<9>(knots, t, order, result);
    default:
      return basisFunctionsOfAnyOrder(knots, degree, t, order, result);
  }
}

int polarForm(std::span<const double> knots, int degree, double at, std::span<const double> arguments,
              std::span<double> weight) {
  TRIMQUAD_ASSERT(int(arguments.size()) == degree && int(weight.size()) > degree);
  const int span = knotSpan(knots, degree, at);
  weight[0] = 1;
  for (int j = 1; j <= degree; ++j) {
    double saved = 0;
    for (int r = 0; r < j; ++r) {
      const double left = knots[span + 1 - j + r], right = knots[span + 1 + r];
      const double part = weight[r] / (right - left);
      weight[r] = saved + (right - arguments[j - 1]) * part;
      saved = (arguments[j - 1] - left) * part;
    }
    weight[j] = saved;
  }
  return span - degree;
}

template <int Dim>
std::vector<typename SplineCurve<Dim>::Point> SplineCurve<Dim>::derivatives(double t, int order) const {
  BasisFunctions basis;
  basisFunctions(knots, degree, t, order, basis);
  std::vector<Point> result(order + 1, Point::Zero());
  for (int k = 0; k <= order; ++k)
    for (int j = 0; j <= degree; ++j) result[k] += basis.value[k][j] * poles[basis.first + j];
  return result;
}

template <int Dim>
SplineCurve<Dim> withKnot(SplineCurve<Dim> curve, double t, int times) {
  const int p = curve.degree;
  TRIMQUAD_ASSERT(t > curve.first() && t < curve.last());
  for (; times > 0; --times) {
    const int span = knotSpan(curve.knots, p, t);
    auto poles = curve.poles;
    poles.insert(poles.begin() + span, poles[span]);
    for (int i = span - p + 1; i <= span; ++i) {
      const double width = curve.knots[i + p] - curve.knots[i];
      const double alpha = width > 0 ? (t - curve.knots[i]) / width : 0;
      poles[i] = (1 - alpha) * curve.poles[i - 1] + alpha * curve.poles[i];
    }
    for (int i = span + 1; i < int(poles.size()); ++i) poles[i] = curve.poles[i - 1];
    curve.poles = std::move(poles);
    curve.knots.insert(curve.knots.begin() + span + 1, t);
  }
  return curve;
}

template <int Dim>
SplineCurve<Dim> restricted(const SplineCurve<Dim>& curve, double a, double b) {
  const int p = curve.degree;
  TRIMQUAD_ASSERT(curve.first() <= a && a < b && b <= curve.last());
  SplineCurve<Dim> piece = curve;
  for (const double t : {a, b})
    if (t > curve.first() && t < curve.last()) {
      const auto [low, high] = std::equal_range(piece.knots.begin(), piece.knots.end(), t);
      piece = withKnot(std::move(piece), t, std::max(0, p - int(high - low)));
    }
  const auto begin = std::upper_bound(piece.knots.begin(), piece.knots.end(), a) - p;
  const auto end = std::lower_bound(piece.knots.begin(), piece.knots.end(), b);
  std::vector<double> knots{a};
  knots.insert(knots.end(), begin, end);
  knots.insert(knots.end(), p + 1, b);
  const auto firstPole = begin - piece.knots.begin() - 1;
  piece.poles = {piece.poles.begin() + firstPole, piece.poles.begin() + firstPole + (knots.size() - p - 1)};
  piece.knots = std::move(knots);
  return piece;
}

template struct SplineCurve<2>;
template struct SplineCurve<3>;
template PlaneCurve withKnot(PlaneCurve, double, int);
template SpaceCurve withKnot(SpaceCurve, double, int);
template PlaneCurve restricted(const PlaneCurve&, double, double);
template SpaceCurve restricted(const SpaceCurve&, double, double);

namespace {

/// sum_ij value(k, i) value(l, j) pole(i, j).
Eigen::Vector3d combination(const SplineSurface& s, const BasisFunctions& bu, const BasisFunctions& bv, int k,
                            int l) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int j = 0; j <= s.degreeV; ++j) {
    const Eigen::Vector3d* row = &s.poles[bu.first + s.countU * (bv.first + j)];
    Eigen::Vector3d inRow = Eigen::Vector3d::Zero();
    for (int i = 0; i <= s.degreeU; ++i) inRow += bu.value[k][i] * row[i];
    sum += bv.value[l][j] * inRow;
  }
  return sum;
}

}  // namespace

Eigen::Vector3d SplineSurface::point(double u, double v) const {
  BasisFunctions bu, bv;
  basisFunctions(knotsU, degreeU, u, 0, bu);
  basisFunctions(knotsV, degreeV, v, 0, bv);
  return combination(*this, bu, bv, 0, 0);
}

SplineSurface::Jet SplineSurface::jet(double u, double v) const {
  BasisFunctions bu, bv;
  basisFunctions(knotsU, degreeU, u, 2, bu);
  basisFunctions(knotsV, degreeV, v, 2, bv);
  Jet jet;
  jet.s = jet.su = jet.sv = jet.suu = jet.suv = jet.svv = Eigen::Vector3d::Zero();
  for (int j = 0; j <= degreeV; ++j) {
    const Eigen::Vector3d* row = &poles[bu.first + countU * (bv.first + j)];
    Eigen::Vector3d r0 = Eigen::Vector3d::Zero(), r1 = r0, r2 = r0;
    for (int i = 0; i <= degreeU; ++i) {
      r0 += bu.value[0][i] * row[i];
      r1 += bu.value[1][i] * row[i];
      r2 += bu.value[2][i] * row[i];
    }
    jet.s += bv.value[0][j] * r0;
    jet.su += bv.value[0][j] * r1;
    jet.suu += bv.value[0][j] * r2;
    jet.sv += bv.value[1][j] * r0;
    jet.suv += bv.value[1][j] * r1;
    jet.svv += bv.value[2][j] * r0;
  }
  return jet;
}

std::vector<Eigen::Vector3d> SplineSurface::derivatives(double u, double v, int order) const {
  BasisFunctions bu, bv;
  basisFunctions(knotsU, degreeU, u, order, bu);
  basisFunctions(knotsV, degreeV, v, order, bv);
  std::vector<Eigen::Vector3d> result;
  result.reserve((order + 1) * (order + 1));
  for (int l = 0; l <= order; ++l)
    for (int k = 0; k <= order; ++k) result.push_back(combination(*this, bu, bv, k, l));
  return result;
}

double SplineSurface::wrappedU(double u) const {
  if (!closedU) return u;
  const double period = lastU() - firstU();
  u -= period * std::floor((u - firstU()) / period);
  return u < lastU() ? std::max(u, firstU()) : firstU();
}

Eigen::Vector2d SplineSurface::footPoint(const Eigen::Vector3d& p, const Eigen::Vector2d& guess,
                                         double step) const {
  return footPoint(p, guess, {Eigen::Vector2d(firstU(), firstV()), Eigen::Vector2d(lastU(), lastV())}, step);
}

Eigen::Vector2d SplineSurface::footPoint(const Eigen::Vector3d& p, const Eigen::Vector2d& guess,
                                         const Eigen::AlignedBox2d& part, double smallestStep) const {
  const Eigen::Vector2d &low = part.min(), &high = part.max();
  const auto admissible = [&](const Eigen::Vector2d& x) -> Eigen::Vector2d {
    return {closedU ? wrappedU(x[0]) : std::clamp(x[0], low[0], high[0]), std::clamp(x[1], low[1], high[1])};
  };
  constexpr int maxSteps = 40;
  Eigen::Vector2d x = admissible(guess);
  Jet jet = this->jet(x[0], x[1]);
  for (int step = 0; step < maxSteps; ++step) {
    const Eigen::Vector3d d = jet.s - p;
    const double distance2 = d.squaredNorm();
    Eigen::Vector2d gradient(d.dot(jet.su), d.dot(jet.sv));
    Eigen::Matrix2d gauss;
    gauss << jet.su.dot(jet.su), jet.su.dot(jet.sv), jet.su.dot(jet.sv), jet.sv.dot(jet.sv);
    Eigen::Matrix2d hessian = gauss;
    hessian(0, 0) += d.dot(jet.suu);
    hessian(0, 1) += d.dot(jet.suv);
    hessian(1, 0) += d.dot(jet.suv);
    hessian(1, 1) += d.dot(jet.svv);
    // A parameter that stands on the part's end and would leave it stays there.
    const bool holdU =
        !closedU && ((x[0] <= low[0] && gradient[0] > 0) || (x[0] >= high[0] && gradient[0] < 0));
    const bool holdV = (x[1] <= low[1] && gradient[1] > 0) || (x[1] >= high[1] && gradient[1] < 0);
    for (const auto& [hold, k] : {std::pair{holdU, 0}, std::pair{holdV, 1}})
      if (hold) {
        gradient[k] = 0;
        for (auto* m : {&hessian, &gauss}) {
          (*m)(0, 1) = (*m)(1, 0) = 0;
          (*m)(k, k) = 1;
        }
      }
    // Newton where the Hessian is well inside the positive definite ones, Gauss-Newton elsewhere.
    const bool convex =
        hessian(0, 0) > 0 && hessian.determinant() > 1e-3 * std::abs(gauss.determinant()) && gauss(0, 0) > 0;
    Eigen::Matrix2d model = convex ? hessian : gauss;
    model.diagonal().array() += 1e-14 * model.trace();
    const double det = model.determinant();
    if (!(det > 0)) break;
    Eigen::Vector2d move(-(model(1, 1) * gradient[0] - model(0, 1) * gradient[1]) / det,
                         -(model(0, 0) * gradient[1] - model(1, 0) * gradient[0]) / det);
    const Eigen::Vector2d scale(std::max(1.0, std::abs(x[0])), std::max(1.0, std::abs(x[1])));
    if ((move.array() / scale.array()).abs().maxCoeff() < smallestStep) break;
    // Near the foot the distance stands still within rounding long before the parameters do; there the
    // gradient decides.
    const double rounding = 1e-14 * (distance2 + p.norm() * std::sqrt(distance2));
    bool moved = false;
    for (int halving = 0; halving < 12 && !moved; ++halving, move *= 0.5) {
      const Eigen::Vector2d y = admissible(x + move);
      const Jet there = this->jet(y[0], y[1]);
      const Eigen::Vector3d e = there.s - p;
      const Eigen::Vector2d remaining(holdU ? 0 : e.dot(there.su), holdV ? 0 : e.dot(there.sv));
      const double change = e.squaredNorm() - distance2;
      if (change < -rounding || (change < rounding && remaining.norm() < 0.5 * gradient.norm())) {
        x = y;
        jet = there;
        moved = true;
      }
    }
    if (!moved) break;
  }
  return x;
}

SpaceCurve SplineSurface::curveAtU(double u) const {
  BasisFunctions bu;
  basisFunctions(knotsU, degreeU, u, 0, bu);
  SpaceCurve curve{degreeV, knotsV, std::vector<Eigen::Vector3d>(countV, Eigen::Vector3d::Zero())};
  for (int j = 0; j < countV; ++j)
    for (int i = 0; i <= degreeU; ++i) curve.poles[j] += bu.value[0][i] * pole(bu.first + i, j);
  return curve;
}

SpaceCurve SplineSurface::curveAtV(double v) const {
  BasisFunctions bv;
  basisFunctions(knotsV, degreeV, v, 0, bv);
  SpaceCurve curve{degreeU, knotsU, std::vector<Eigen::Vector3d>(countU, Eigen::Vector3d::Zero())};
  for (int i = 0; i < countU; ++i)
    for (int j = 0; j <= degreeV; ++j) curve.poles[i] += bv.value[0][j] * pole(i, bv.first + j);
  return curve;
}

namespace {

/// The surface whose rows, at constant v, are `of` each row.
template <class Of>
SplineSurface rowByRow(const SplineSurface& surface, const Of& of) {
  SplineSurface result = surface;
  result.poles.clear();
  for (int j = 0; j < surface.countV; ++j) {
    const auto row = surface.poles.begin() + std::ptrdiff_t(surface.countU) * j;
    SpaceCurve other = of(SpaceCurve{surface.degreeU, surface.knotsU, {row, row + surface.countU}});
    result.poles.insert(result.poles.end(), other.poles.begin(), other.poles.end());
    result.countU = int(other.poles.size());
    result.knotsU = std::move(other.knots);
  }
  return result;
}

/// The same for columns, at constant u.
template <class Of>
SplineSurface columnByColumn(const SplineSurface& surface, const Of& of) {
  SplineSurface result = surface;
  for (int i = 0; i < surface.countU; ++i) {
    std::vector<Eigen::Vector3d> column(surface.countV);
    for (int j = 0; j < surface.countV; ++j) column[j] = surface.pole(i, j);
    SpaceCurve other = of(SpaceCurve{surface.degreeV, surface.knotsV, std::move(column)});
    result.countV = int(other.poles.size());
    result.poles.resize(std::size_t(result.countU) * result.countV);
    for (int j = 0; j < result.countV; ++j) result.poles[i + result.countU * j] = other.poles[j];
    result.knotsV = std::move(other.knots);
  }
  return result;
}

}  // namespace

SplineSurface withKnotU(const SplineSurface& surface, double u, int times) {
  return rowByRow(surface, [&](SpaceCurve row) { return withKnot(std::move(row), u, times); });
}

SplineSurface withKnotV(const SplineSurface& surface, double v, int times) {
  return columnByColumn(surface, [&](SpaceCurve column) { return withKnot(std::move(column), v, times); });
}

SplineSurface restricted(const SplineSurface& surface, const Eigen::AlignedBox2d& part) {
  const Eigen::Vector2d low = part.min(), high = part.max();
  SplineSurface result =
      rowByRow(surface, [&](const SpaceCurve& row) { return restricted(row, low[0], high[0]); });
  result =
      columnByColumn(result, [&](const SpaceCurve& column) { return restricted(column, low[1], high[1]); });
  result.closedU = surface.closedU && result.knotsU == surface.knotsU;
  return result;
}

double nearestParameter(const SpaceCurve& curve, const Eigen::Vector3d& p, double guess) {
  double s = guess;
  constexpr int maxSteps = 30;
  for (int step = 0; step < maxSteps; ++step) {
    const auto r = curve.derivatives(s, 2);
    const double slope = -r[1].squaredNorm() + (p - r[0]).dot(r[2]);
    if (!(slope < 0)) break;
    const double move = -(p - r[0]).dot(r[1]) / slope;
    s += move;
    if (std::abs(move) < 1e-15 * (curve.last() - curve.first())) break;
  }
  return s;
}

}  // namespace trimquad
