#pragma once

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "trimquad/base/progress.h"
#include "trimquad/spline/spline_geometry.h"

namespace trimquad {

/// Value and derivatives of a curve at one parameter.
template <int Dim>
struct CurveJet {
  Eigen::Matrix<double, Dim, 1> value, first, second;
};

inline constexpr int kChainDegree = 9;

/// `breaks` with those left out that follow another one by less than 1e-4 of the range: narrower pieces would
/// spoil the conditioning of the joints. Ends stay.
inline std::vector<double> mergedBreaks(std::vector<double> breaks, double first, double last) {
  const double narrowest = 1e-4 * (last - first);
  std::sort(breaks.begin(), breaks.end());
  std::vector<double> merged{first};
  for (const double s : breaks)
    if (s > merged.back() + narrowest && s < last - narrowest) merged.push_back(s);
  merged.push_back(last);
  return merged;
}

/// One polynomial of degree 9 in Bernstein form that interpolates `jet` at both ends up to derivative
/// `continuity` (1 or 2) and in as many Chebyshev points between as there are coefficients left.
template <int Dim, class Jet>
std::vector<Eigen::Matrix<double, Dim, 1>> hermitePiece(const Jet& jet, const CurveJet<Dim>& start,
                                                        const CurveJet<Dim>& end, double a, double b,
                                                        int continuity) {
  constexpr int n = kChainDegree;
  const double h = b - a;
  std::vector<Eigen::Matrix<double, Dim, 1>> c(n + 1, Eigen::Matrix<double, Dim, 1>::Zero());
  c[0] = start.value;
  c[n] = end.value;
  c[1] = c[0] + start.first * (h / n);
  c[n - 1] = c[n] - end.first * (h / n);
  if (continuity == 2) {
    c[2] = 2 * c[1] - c[0] + start.second * (h * h / (n * (n - 1)));
    c[n - 2] = 2 * c[n - 1] - c[n] + end.second * (h * h / (n * (n - 1)));
  }
  const int from = continuity + 1, free = n + 1 - 2 * from;
  Eigen::MatrixXd matrix(free, free);
  Eigen::Matrix<double, Eigen::Dynamic, Dim> rhs(free, Dim);
  for (int k = 0; k < free; ++k) {
    const double x = (1 - std::cos(std::numbers::pi * (2 * k + 1) / (2 * free))) / 2;
    rhs.row(k) = jet(a + h * x).value.transpose();
    double binomial = 1;
    for (int i = 0; i <= n; ++i) {
      const double basis = binomial * std::pow(x, i) * std::pow(1 - x, n - i);
      if (i >= from && i < from + free)
        matrix(k, i - from) = basis;
      else
        rhs.row(k) -= basis * c[i].transpose();
      binomial *= double(n - i) / (i + 1);
    }
  }
  const Eigen::Matrix<double, Eigen::Dynamic, Dim> inner = matrix.partialPivLu().solve(rhs);
  for (int i = 0; i < free; ++i) c[from + i] = inner.row(i).transpose();
  return c;
}

/// The value at `s` of a polynomial over [a, b] in Bernstein form.
template <class Point>
Point bernsteinPoint(std::vector<Point> c, double a, double b, double s) {
  const double x = (s - a) / (b - a);
  for (std::size_t m = c.size() - 1; m > 0; --m)
    for (std::size_t i = 0; i < m; ++i) c[i] = (1 - x) * c[i] + x * c[i + 1];
  return c[0];
}

/// A curve of degree 9, C1 or C2, through `jet(s)`: Hermite pieces, cut until `deviation(s, value)` is at
/// most `tolerance` in all test points of each (or the piece is 1e-5 of the range). Cuts go through the break
/// nearest to a piece's middle, and through the middle where there is no break left. (two-point Hermite
/// interpolation; the joints' knots have multiplicity 9 - continuity) \param breaks ascending, the range's
/// ends first and last; where `jet` is less smooth than inside
template <int Dim, class Jet, class Deviation>
SplineCurve<Dim> hermiteChain(const Jet& jet, const std::vector<double>& breaks, int continuity,
                              const Deviation& deviation, double tolerance, const Progress& progress) {
  using Point = Eigen::Matrix<double, Dim, 1>;
  constexpr int n = kChainDegree, tests = 24;
  const double narrowest = 1e-5 * (breaks.back() - breaks.front());
  const auto cut = [&](double a, double b) {
    const double middle = (a + b) / 2;
    const auto above = std::lower_bound(breaks.begin(), breaks.end(), middle);
    double best = middle, distance = b - a;
    for (auto it = above == breaks.begin() ? above : above - 1; it != breaks.end() && it <= above; ++it)
      if (*it > a && *it < b && std::abs(*it - middle) < distance) {
        best = *it;
        distance = std::abs(best - middle);
      }
    return best;
  };
  struct End {
    double s;
    CurveJet<Dim> jet;
  };
  End from{breaks.front(), jet(breaks.front())};
  std::vector<End> ahead{{breaks.back(), jet(breaks.back())}};  // joints still to reach, the next one last
  std::vector<double> joints{from.s};
  std::vector<std::vector<Point>> pieces;
  while (!ahead.empty()) {
    progress.check();
    const double a = from.s, b = ahead.back().s;
    auto piece = hermitePiece<Dim>(jet, from.jet, ahead.back().jet, a, b, continuity);
    bool good = true;
    for (int k = 0; k < tests && good; ++k) {
      const double s = a + (b - a) * (k + 0.5) / tests;
      good = deviation(s, bernsteinPoint(piece, a, b, s)) <= tolerance;
    }
    if (!good && b - a > narrowest) {
      const double s = cut(a, b);
      ahead.push_back({s, jet(s)});
      continue;
    }
    pieces.push_back(std::move(piece));
    joints.push_back(b);
    from = ahead.back();
    ahead.pop_back();
  }
  SplineCurve<Dim> curve;
  curve.degree = n;
  curve.knots.assign(n + 1, joints.front());
  for (std::size_t i = 1; i + 1 < joints.size(); ++i)
    curve.knots.insert(curve.knots.end(), n - continuity, joints[i]);
  curve.knots.insert(curve.knots.end(), n + 1, joints.back());
  // The knots' multiplicity leaves out the last coefficients of a piece and the first ones of the next, which
  // the derivatives at the joint determine. With C2 one pole stands between: the polar form at (a, 7 times b,
  // c).
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const auto& c = pieces[k];
    const bool last = k + 1 == pieces.size();
    curve.poles.insert(curve.poles.end(), c.begin() + (k == 0 ? 0 : continuity),
                       last ? c.end() : c.end() - continuity);
    if (continuity == 2 && !last) {
      const double ratio = (joints[k + 2] - joints[k]) / (joints[k + 1] - joints[k]);
      curve.poles.push_back(c[n - 2] + ratio * (c[n - 1] - c[n - 2]));
    }
  }
  return curve;
}

}  // namespace trimquad
