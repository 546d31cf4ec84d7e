#include "trimquad/spline/spline_space.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "trimquad/base/error.h"
#include "trimquad/base/sparse_solver.h"
#include "trimquad/spline/block_cholesky.h"
#include "trimquad/spline/sliding_data.h"

namespace trimquad {
namespace {

constexpr int kMaxLocal = kMaxSplineDegree + 1;
/// From this many unknowns on a line of blocks, sparse elimination costs less than the full band.
constexpr int kLargestBlock = 300;

/// Where the unknowns stand in the linear system: whole lines of poles one after the other, along the
/// direction in which blocks of neighbouring lines are smaller. A closed direction is folded up (0, n - 1, 1,
/// n - 2, ...), which doubles its band instead of coupling the last line to the first.
struct Numbering {
  bool alongU;
  int lines, lineSize, blockSize;
  bool folded;

  explicit Numbering(const SplineSpace& space) {
    const int blockU = (space.u.closed ? 2 : 1) * space.u.degree * space.v.unknowns();
    const int blockV = space.v.degree * space.u.unknowns();
    alongU = blockU < blockV;
    blockSize = alongU ? blockU : blockV;
    lines = alongU ? space.u.unknowns() : space.v.unknowns();
    lineSize = alongU ? space.v.unknowns() : space.u.unknowns();
    folded = alongU && space.u.closed;
  }

  int operator()(int i, int j) const {
    const int line = alongU ? i : j, inLine = alongU ? j : i;
    const int place = !folded ? line : 2 * line < lines ? 2 * line : 2 * (lines - 1 - line) + 1;
    return place * lineSize + inLine;
  }
};

/// The unknowns whose functions do not vanish on one knot rectangle, at a + (degreeU + 1) * b.
struct LocalUnknowns {
  int count = 0;
  std::array<int, kMaxLocal * kMaxLocal> index;

  LocalUnknowns(const SplineSpace& space, const Numbering& number, int spanU, int spanV) {
    for (int b = 0; b <= space.v.degree; ++b)
      for (int a = 0; a <= space.u.degree; ++a) {
        const int i = space.u.closed ? (spanU + a) % space.u.unknowns() : spanU + a;
        index[count++] = number(i, spanV + b);
      }
  }

  /// Calls add(i, j, value) for the entries on and below the diagonal.
  template <class Add>
  void forEachEntry(const Eigen::MatrixXd& local, const Add& add) const {
    for (int y = 0; y < count; ++y)
      for (int x = 0; x < count; ++x)
        if (index[x] >= index[y]) add(index[x], index[y], local(x, y));
  }
};

/// Poles of one row, as the clamped curve over one period with its ends equal bit by bit.
SpaceCurve clampedPeriod(const SplineLine& line, const std::vector<Eigen::Vector3d>& periodic) {
  // One span more on both sides of the period, so that its ends are inner knots that can be made full.
  const int p = line.degree, n = line.unknowns();
  const double period = line.breaks.back() - line.breaks.front();
  SpaceCurve extended{p, {}, {}};
  const auto knotAt = [&](int i) {
    const int turn = int(std::floor(double(i) / n));
    return line.breaks[i - turn * n] + turn * period;
  };
  for (int i = -p - 1; i <= n + p + 1; ++i) extended.knots.push_back(knotAt(i));
  for (int i = -1; i <= n + p; ++i) extended.poles.push_back(periodic[((i % n) + n) % n]);
  SpaceCurve curve = restricted(extended, line.breaks.front(), line.breaks.back());
  curve.poles.back() = curve.poles.front();
  return curve;
}

SplineSurface surfaceOf(const SplineSpace& space, const Numbering& number, const Eigen::MatrixXd& poles) {
  SplineSurface s = space.emptySurface();
  s.closedU = space.u.closed;
  for (int j = 0; j < s.countV; ++j) {
    std::vector<Eigen::Vector3d> row;
    for (int i = 0; i < space.u.unknowns(); ++i) row.push_back(poles.row(number(i, j)));
    if (space.u.closed) {
      auto curve = clampedPeriod(space.u, row);
      row = std::move(curve.poles);
      s.knotsU = std::move(curve.knots);
    }
    s.poles.insert(s.poles.end(), row.begin(), row.end());
  }
  s.countU = int(s.knotsU.size()) - s.degreeU - 1;
  return s;
}

}  // namespace

// By Gauss-Legendre quadrature.
std::array<Eigen::MatrixXd, 3> spanProducts(const SplineLine& line, const std::vector<double>& knots,
                                            int span) {
  const int n = line.degree + 1;
  // Nodes of the n-point rule by Newton on the Legendre polynomial.
  std::array<Eigen::MatrixXd, 3> product;
  for (auto& m : product) m = Eigen::MatrixXd::Zero(n, n);
  BasisFunctions basis;
  for (int q = 0; q < n; ++q) {
    double x = std::cos(M_PI * (q + 0.75) / (n + 0.5)), slope = 1;
    for (int step = 0; step < 50; ++step) {
      double p0 = 1, p1 = x;
      for (int k = 2; k <= n; ++k) {
        const double p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
        p0 = p1;
        p1 = p2;
      }
      slope = n * (x * p1 - p0) / (x * x - 1);
      const double move = p1 / slope;
      x -= move;
      if (std::abs(move) < 1e-15) break;
    }
    const double weight = line.width(span) / ((1 - x * x) * slope * slope);
    const double t = 0.5 * (line.breaks[span] + line.breaks[span + 1] + x * line.width(span));
    basisFunctions(knots, line.degree, t, 2, basis);
    for (int k = 0; k < 3; ++k)
      for (int a = 0; a < n; ++a)
        for (int b = 0; b < n; ++b) product[k](a, b) += weight * basis.value[k][a] * basis.value[k][b];
  }
  return product;
}

int SplineLine::spanOf(double t) const {
  return int(std::upper_bound(breaks.begin() + 1, breaks.end() - 1, t) - breaks.begin()) - 1;
}

std::vector<double> SplineLine::knots() const {
  std::vector<double> result;
  const int n = spans();
  const double period = breaks.back() - breaks.front();
  for (int i = -degree; i <= n + degree; ++i) {
    if (!closed) {
      result.push_back(breaks[std::clamp(i, 0, n)]);
      continue;
    }
    const int turn = int(std::floor(double(i) / n));
    result.push_back(breaks[i - turn * n] + turn * period);
  }
  return result;
}

SplineSurface SplineSpace::emptySurface() const {
  SplineSurface s;
  s.degreeU = u.degree;
  s.degreeV = v.degree;
  s.knotsU = u.knots();
  s.knotsV = v.knots();
  s.countU = u.unknowns();
  s.countV = v.unknowns();
  return s;
}

bool Fairness::isStiff(const SplineLine& u, int i, const SplineLine& v, int j) const {
  const Eigen::Vector2d low(u.breaks[i], v.breaks[j]), high(u.breaks[i + 1], v.breaks[j + 1]);
  return std::any_of(stiff.begin(), stiff.end(), [&](const StiffPlace& place) {
    return (place.at - place.at.cwiseMax(low).cwiseMin(high)).norm() < place.reach;
  });
}

double Fairness::weight(const SplineLine& u, int i, const SplineLine& v, int j, bool hasData) const {
  // Below one quad the energy counts by the knot rectangle: it must not hold back knots that follow a crease.
  const double size = isStiff(u, i, v, j) ? 1 : std::clamp(u.width(i) * v.width(j), 1e-3, 1.0);
  double result = size * size * (hasData ? withData : withoutData);
  const Eigen::Vector2d low(u.breaks[i], v.breaks[j]), high(u.breaks[i + 1], v.breaks[j + 1]);
  for (const auto& spot : spots)
    if ((spot.at - spot.at.cwiseMax(low).cwiseMin(high)).lpNorm<Eigen::Infinity>() < spot.reach)
      result = std::max(result, spot.factor * withData);
  if (!stiffness.empty()) result *= stiffness[0][i + std::size_t(u.spans()) * j];
  return result;
}

Fairness Fairness::ofChart(int chart) const {
  Fairness result = *this;
  result.spots.clear();
  for (Spot spot : spots)
    if (spot.chart == chart) {
      spot.chart = 0;
      result.spots.push_back(spot);
    }
  if (!stiffness.empty()) result.stiffness = {stiffness[chart]};
  return result;
}

/// Calls emit(span in u, span in v, normal matrix, right-hand side) for every knot rectangle; local unknown
/// (a, b) has the number a + (degreeU + 1) * b.
template <class Emit>
void SplineSpace::forEachRectangle(const std::vector<Datum>& data, const Fairness& fairness,
                                   const Eigen::Vector3d& middle, const Progress* progress,
                                   const Emit& emit) const {
  const auto knotsU = u.knots(), knotsV = v.knots();
  // Data by knot rectangle, so that each one's products are summed before they go to the matrix.
  std::vector<std::pair<int, int>> order(data.size());
  for (int i = 0; i < int(data.size()); ++i)
    order[i] = {u.spanOf(data[i].parameter[0]) + u.spans() * v.spanOf(data[i].parameter[1]), i};
  std::sort(order.begin(), order.end());

  std::vector<std::array<Eigen::MatrixXd, 3>> productsU, productsV;
  for (int i = 0; i < u.spans(); ++i) productsU.push_back(spanProducts(u, knotsU, i));
  for (int j = 0; j < v.spans(); ++j) productsV.push_back(spanProducts(v, knotsV, j));

  const int nu = u.degree + 1, nv = v.degree + 1;
  Eigen::MatrixXd local(nu * nv, nu * nv), localRhs(nu * nv, 3);
  Eigen::VectorXd value(nu * nv);
  BasisFunctions bu, bv;
  auto next = order.begin();
  for (int j = 0; j < v.spans(); ++j) {
    if (progress) progress->check();
    for (int i = 0; i < u.spans(); ++i) {
      const bool hasData = next != order.end() && next->first == i + u.spans() * j;
      const double lambda = fairness.weight(u, i, v, j, hasData);
      for (int b = 0; b < nv; ++b)
        for (int d = 0; d < nv; ++d)
          local.block(b * nu, d * nu, nu, nu) = lambda * (productsV[j][0](b, d) * productsU[i][2] +
                                                          2 * productsV[j][1](b, d) * productsU[i][1] +
                                                          productsV[j][2](b, d) * productsU[i][0]);
      localRhs.setZero();
      for (; next != order.end() && next->first == i + u.spans() * j; ++next) {
        const Datum& d = data[next->second];
        basisFunctions(knotsU, u.degree, d.parameter[0], 0, bu);
        basisFunctions(knotsV, v.degree, d.parameter[1], 0, bv);
        for (int b = 0; b < nv; ++b)
          for (int a = 0; a < nu; ++a) value[a + nu * b] = bu.value[0][a] * bv.value[0][b];
        local.selfadjointView<Eigen::Lower>().rankUpdate(value, d.weight);
        for (int x = 0; x < nu * nv; ++x)
          localRhs.row(x) += d.weight * value[x] * (d.point - middle).transpose();
      }
      local.triangularView<Eigen::StrictlyUpper>() = local.transpose();
      emit(i, j, local, localRhs);
    }
  }
}

template <class Number>
void SplineSpace::addSliding(const std::vector<Datum>& data, const Eigen::Vector3d& middle,
                             const Number& number, SlidingData& sliding) const {
  const auto knotsU = u.knots(), knotsV = v.knots();
  BasisFunctions bu, bv;
  std::vector<std::pair<int, double>> terms;
  for (const Datum& d : data) {
    if (d.free.isZero()) continue;
    basisFunctions(knotsU, u.degree, d.parameter[0], 0, bu);
    basisFunctions(knotsV, v.degree, d.parameter[1], 0, bv);
    terms.clear();
    for (int b = 0; b <= v.degree; ++b)
      for (int a = 0; a <= u.degree; ++a) {
        const int i = u.closed ? (bu.first + a) % u.unknowns() : bu.first + a;
        terms.emplace_back(number(i, bv.first + b), bu.value[0][a] * bv.value[0][b]);
      }
    sliding.add(d, d.point - middle, terms);
  }
}

std::optional<SplineSurface> SplineSpace::leastSquares(const std::vector<Datum>& data,
                                                       const Fairness& fairness,
                                                       const Progress& progress) const {
  const Numbering number(*this);
  Eigen::MatrixXd rhs = Eigen::MatrixXd::Zero(poles(), 3);
  // Rounding is relative to the coordinates, so they are taken from the middle of the data.
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const auto& d : data) middle += d.point / double(data.size());
  const auto assemble = [&](const auto& add) {
    forEachRectangle(data, fairness, middle, &progress,
                     [&](int i, int j, const auto& local, const auto& localRhs) {
                       const LocalUnknowns unknowns(*this, number, i, j);
                       unknowns.forEachEntry(local, add);
                       for (int x = 0; x < unknowns.count; ++x) rhs.row(unknowns.index[x]) += localRhs.row(x);
                     });
  };
  SlidingData sliding;
  addSliding(data, middle, number, sliding);
  if (number.blockSize <= kLargestBlock) {
    BlockCholesky matrix(poles(), number.blockSize);
    assemble([&](int i, int j, double value) { matrix.add(i, j, value); });
    if (!matrix.factorize(progress)) return {};
    const auto solve = [&](Eigen::MatrixXd x) {
      matrix.solveInPlace(x);
      return x;
    };
    rhs = sliding.minimum(solve(std::move(rhs)), solve, progress);
  } else {
    std::vector<Eigen::Triplet<double>> entries;
    assemble([&](int i, int j, double value) { entries.emplace_back(i, j, value); });
    Eigen::SparseMatrix<double> matrix(poles(), poles());
    matrix.setFromTriplets(entries.begin(), entries.end());
    entries = {};
    SparseSolver solver("fit");
    progress.check();
    if (!solver.tryFactorize(matrix)) return {};
    const auto solve = [&](const Eigen::MatrixXd& x) { return solver.solve(x); };
    rhs = sliding.minimum(solve(rhs), solve, progress);
  }
  rhs.rowwise() += middle.transpose();
  return surfaceOf(*this, number, rhs);
}

void SplineSpace::addNormalEquations(const std::vector<Datum>& data, const Fairness& fairness,
                                     const Eigen::Vector3d& middle, int offset,
                                     std::vector<Eigen::Triplet<double>>& entries,
                                     Eigen::MatrixXd& rhs) const {
  TRIMQUAD_ASSERT(!u.closed && !v.closed);
  forEachRectangle(
      data, fairness, middle, nullptr, [&](int i, int j, const auto& local, const auto& localRhs) {
        const int nu = u.degree + 1, n = nu * (v.degree + 1);
        const auto index = [&](int x) { return offset + i + x % nu + u.unknowns() * (j + x / nu); };
        for (int y = 0; y < n; ++y) {
          rhs.row(index(y)) += localRhs.row(y);
          for (int x = y; x < n; ++x) entries.emplace_back(index(x), index(y), local(x, y));
        }
      });
}

}  // namespace trimquad
