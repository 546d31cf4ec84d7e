#include "trimquad/spline/joined_space.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "trimquad/base/error.h"
#include "trimquad/base/sparse_solver.h"

namespace trimquad {
namespace {

constexpr int kMaxMultiplierSteps = 200;
constexpr int kIdleMultiplierSteps = 60;
/// Violations of exact conditions that are left, relative to the extent of the data.
constexpr double kRounding = 1e-13;
/// How far from singularities narrow knot rectangles count in full towards fairness at first, quads.
constexpr double kStiffReach = 0.25;
/// How far the influence of a singularity reaches along a border, quads; to the next knot from there.
constexpr double kTangentReach = 2;
/// Tangents at a singularity are taken from data this close to it, quads; from so many at least.
constexpr double kTangentRadius = 1;
constexpr int kFewestForTangent = 8;
/// Borders that leave a singularity under a smaller angle are spread evenly, radians.
constexpr double kSmallestAngle = 0.3;
constexpr double kSame = 1e-9;  ///< quads

using Terms = std::vector<std::pair<int, double>>;

/// Evaluates the splines of one chart as combinations of its unknowns.
class ChartEvaluator {
 public:
  ChartEvaluator(const SplineSpace& space, int offset)
      : space_(space), offset_(offset), knots_{space.u.knots(), space.v.knots()} {}

  /// Appends factor * the derivative along a unit vector of the grid.
  void appendAlong(const Eigen::Vector2d& x, const Eigen::Vector2d& direction, double factor,
                   Terms& terms) const {
    const int axis = direction[0] != 0 ? 0 : 1;
    Functions f[2];
    for (int k : {0, 1}) f[k] = functions(k, x[k], k == axis ? 1 : 0);
    append(f[0], f[1], factor * direction[axis], terms);
  }

  /// Appends factor times the polar form along `axis`, in the span that holds `at`, of the surface on the
  /// line where the other coordinate is `line`, or of its `order`-th derivative across that line.
  void appendPolar(int axis, double at, std::span<const double> arguments, double line, int order,
                   double factor, Terms& terms) const {
    Functions f[2];
    f[axis].first = polarForm(knots_[axis], degree(axis), at, arguments, f[axis].value);
    f[1 - axis] = functions(1 - axis, line, order);
    append(f[0], f[1], factor, terms);
  }

 private:
  /// Those of one variable that do not vanish.
  struct Functions {
    int first = 0;
    std::array<double, kMaxSplineDegree + 1> value;
  };

  int degree(int axis) const { return (axis == 0 ? space_.u : space_.v).degree; }

  Functions functions(int axis, double t, int order) const {
    BasisFunctions basis;
    basisFunctions(knots_[axis], degree(axis), t, order, basis);
    return {basis.first, basis.value[order]};
  }

  void append(const Functions& u, const Functions& v, double factor, Terms& terms) const {
    for (int j = 0; j <= degree(1); ++j)
      for (int i = 0; i <= degree(0); ++i) {
        const double value = factor * u.value[i] * v.value[j];
        if (value != 0) terms.push_back({offset_ + u.first + i + space_.u.unknowns() * (v.first + j), value});
      }
  }

  const SplineSpace& space_;
  int offset_;
  std::array<std::vector<double>, 2> knots_;
};

Eigen::Vector2d turned(const Eigen::Vector2d& d, int quarters) {
  Eigen::Vector2d result = d;
  for (int k = 0; k < (quarters & 3); ++k) result = Eigen::Vector2d(-result[1], result[0]);
  return result;
}

/// Distances along the border of the knot lines that cross it, on the side's chart.
std::vector<double> breaksAlong(const SplineSpace& space, const Layout::Border& border, int side) {
  const int axis = 1 - border.axis(side);
  const double start = border.start[side][axis], sign = border.end[side][axis] > start ? 1 : -1;
  std::vector<double> result;
  for (const double at : (axis == 0 ? space.u : space.v).breaks) result.push_back(sign * (at - start));
  std::sort(result.begin(), result.end());
  return result;
}

/// Width of the side's knot intervals next to the border, across it.
double widthBeside(const SplineSpace& space, const Layout::Border& border, int side) {
  const int axis = border.axis(side), other = 1 - axis;
  const SplineLine& line = axis == 0 ? space.u : space.v;
  // The first chart lies to the left.
  const bool above = (border.end[side][other] > border.start[side][other]) == ((axis == 1) == (side == 0));
  return line.width(line.spanOf(border.start[side][axis] + (above ? kSame : -kSame)));
}

}  // namespace

std::vector<int> JoinedSpace::offsets() const {
  std::vector<int> result{0};
  for (const auto& chart : charts) result.push_back(result.back() + chart.poles());
  return result;
}

void JoinedSpace::addBorder(int index, const std::vector<int>& offset,
                            std::vector<Condition>& conditions) const {
  const auto& border = layout_.borders[index];
  const SplineSpace* space[2];
  std::vector<ChartEvaluator> side;
  std::vector<double> breaks[2];
  for (int k : {0, 1}) {
    space[k] = &charts[border.chart[k]];
    side.emplace_back(*space[k], offset[border.chart[k]]);
    breaks[k] = breaksAlong(*space[k], border, k);
  }
  const double length = border.length();
  const Eigen::Vector2d along0 = (border.end[0] - border.start[0]) / length;
  const Eigen::Vector2d along1 = turned(along0, border.across.rotation);
  // The first chart lies to the left.
  const Eigen::Vector2d over0(along0[1], -along0[0]), over1 = turned(over0, border.across.rotation);

  // Beyond the boundary up to the next knot of either side: that far the polynomials are the same anyway.
  double low = 0, high = length;
  const auto& startPoint = layout_.points[border.startPoint];
  const auto& endPoint = layout_.points[border.endPoint];
  if (!startPoint.inner()) {
    low = std::max(breaks[0].front(), breaks[1].front());
    for (int k : {0, 1})
      for (const double s : breaks[k])
        if (s <= -kBeyondBoundary + kSame) low = std::max(low, s);
  }
  if (!endPoint.inner()) {
    high = std::min(breaks[0].back(), breaks[1].back());
    for (int k : {0, 1})
      for (const double s : breaks[k])
        if (s >= length + kBeyondBoundary - kSame) high = std::min(high, s);
  }

  // How far the influence of a singularity at an end reaches: beyond the boundary where the border ends
  // there.
  const auto reach = [&](bool atStart) {
    const auto& other = atStart ? endPoint : startPoint;
    const double end = other.inner() ? length : atStart ? high : length - low;
    const double wanted = std::min(kTangentReach, other.isSingular() ? length / 2 : end);
    double farthest = 0;
    for (int k : {0, 1}) {
      double first = end;
      for (const double s : breaks[k]) {
        const double away = atStart ? s : length - s;
        if (away > wanted - kSame) first = std::min(first, away);
      }
      farthest = std::max(farthest, first);
    }
    return farthest;
  };
  const double reachStart = startPoint.isSingular() ? reach(true) : 0,
               reachEnd = endPoint.isSingular() ? reach(false) : 0;
  const Gluing atStart = gluingOf(index, true), atEnd = gluingOf(index, false);
  // The derivatives into both charts add up to nothing, but for the one along the border next to
  // singularities.
  const auto acrossAt = [&](double s) {
    const double w0 = reachStart > 0 && s < reachStart ? std::pow(1 - s / reachStart, 2) : 0,
                 w1 = reachEnd > 0 && length - s < reachEnd ? std::pow(1 - (length - s) / reachEnd, 2) : 0;
    // Seen from the end, the charts change sides and the border runs the other way.
    const double first = 1 + w0 * (atStart.left - 1) + w1 * (atEnd.right - 1),
                 second = 1 + w0 * (atStart.right - 1) + w1 * (atEnd.left - 1),
                 along = w0 * atStart.along - w1 * atEnd.along;
    const Eigen::Vector2d x0 = border.start[0] + s * along0;
    const Eigen::Vector2d x1 = border.start[1] + s * along1;
    Condition condition;
    side[0].appendAlong(x0, over0, -first, condition.terms);
    side[1].appendAlong(x1, over1, second, condition.terms);
    if (along != 0) side[0].appendAlong(x0, along0, -along, condition.terms);
    return condition;
  };

  // Splines over the knots of both sides agree on an interval where their poles do, and these conditions are
  // well conditioned.
  const int degree = space[0]->u.degree;
  TRIMQUAD_ASSERT(space[0]->v.degree == degree && space[1]->u.degree == degree &&
                  space[1]->v.degree == degree);
  const auto merged = [&](double from, double to) {
    std::vector<double> ends{from, to};
    for (int k : {0, 1})
      for (const double s : breaks[k])
        if (s > from + kSame && s < to - kSame) ends.push_back(s);
    std::sort(ends.begin(), ends.end());
    ends.erase(std::unique(ends.begin(), ends.end(), [](double a, double b) { return b - a < kSame; }),
               ends.end());
    return ends;
  };
  // Derivatives across narrow spans are large numbers: measured by the step to the next poles instead, all
  // conditions are of one size, and their penalties leave the data their digits.
  const double step = std::min(widthBeside(*space[0], border, 0), widthBeside(*space[1], border, 1));
  const auto sameSplines = [&](double from, double to, int order) {
    if (!(to - from > kSame)) return;
    const double scale = order == 1 ? step * step : 1;
    const auto knots = SplineLine{degree, false, merged(from, to)}.knots();
    std::vector<double> arguments(degree);
    for (int i = 0; i + degree + 1 < int(knots.size()); ++i) {
      const int span = knotSpan(knots, degree, (knots[i] + knots[i + degree + 1]) / 2);
      const double at = (knots[span] + knots[span + 1]) / 2;
      Condition equal{{}, exactWeight * scale * (knots[i + degree + 1] - knots[i]) / (degree + 1), true};
      for (int k : {0, 1}) {
        const Eigen::Vector2d &along = k == 0 ? along0 : along1, &over = k == 0 ? over0 : over1;
        const int axis = 1 - border.axis(k);
        const double start = border.start[k][axis], sign = along[axis];
        for (int j = 0; j < degree; ++j) arguments[j] = start + sign * knots[i + 1 + j];
        side[k].appendPolar(axis, start + sign * at, arguments, border.start[k][1 - axis], order,
                            (k == 0 ? 1 : -1) * (order == 1 ? over[1 - axis] : 1), equal.terms);
      }
      conditions.push_back(std::move(equal));
    }
  };
  sameSplines(low, high, 0);
  if (border.feature) return;
  const double nearEnd = std::min(reachStart > 0 ? reachStart : low, high),
               farEnd = std::max(reachEnd > 0 ? length - reachEnd : high, nearEnd);
  sameSplines(nearEnd, farEnd, 1);
  const auto nearly = [&](double from, double to) {
    if (!(to - from > kSame)) return;
    const auto ends = merged(from, to);
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
      const double width = (ends[i + 1] - ends[i]) / (degree + 1);
      for (int k = 0; k <= degree; ++k) {
        Condition smooth = acrossAt(ends[i] + (k + 0.5) * width);
        smooth.weight = tangentWeight * width;
        smooth.exact = false;
        conditions.push_back(std::move(smooth));
      }
    }
  };
  nearly(low, nearEnd);
  nearly(farEnd, high);
  for (const bool start : {true, false})
    if ((start ? reachStart : reachEnd) > 0) {
      Condition flat = acrossAt(start ? 0 : length);
      flat.weight = exactWeight * step * step;
      flat.exact = true;
      conditions.push_back(std::move(flat));
    }
}

/// Moves the minimum of the quadratic to its minimum subject to the exact conditions. The quadratic contains
/// them as penalties, so that the system for their multipliers is well conditioned but for few directions:
/// conjugate gradients, a solve each.
Eigen::MatrixXd JoinedSpace::satisfying(const std::vector<Condition>& conditions, const SparseSolver& solver,
                                        Eigen::MatrixXd x, double rounding, const Progress& progress) {
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<double> weights;
  for (const auto& condition : conditions) {
    if (!condition.exact) continue;
    for (const auto& [i, a] : condition.terms) entries.emplace_back(int(weights.size()), i, a);
    weights.push_back(condition.weight);
  }
  Eigen::SparseMatrix<double, Eigen::RowMajor> rows(int(weights.size()), x.rows());
  rows.setFromTriplets(entries.begin(), entries.end());
  const Eigen::Map<const Eigen::ArrayXd> weight(weights.data(), Eigen::Index(weights.size()));

  // Where the conditions contradict each other by rounding, steps beyond that only amplify it.
  Eigen::MatrixXd best = x;
  int bestStep = 0;
  double bestLeft = std::numeric_limits<double>::infinity();
  Eigen::MatrixXd r = rows * x, z = weight.matrix().asDiagonal() * r, p = z;
  Eigen::RowVector3d size = r.cwiseProduct(z).colwise().sum();
  for (int step = 0; step < kMaxMultiplierSteps && r.size() && r.cwiseAbs().maxCoeff() > rounding; ++step) {
    progress.check();
    const Eigen::MatrixXd move = solver.solve(rows.transpose() * p), q = rows * move;
    Eigen::RowVector3d by = p.cwiseProduct(q).colwise().sum();
    for (int k = 0; k < 3; ++k) by[k] = by[k] > 0 ? size[k] / by[k] : 0;
    x -= move * by.asDiagonal();
    r -= q * by.asDiagonal();
    z = weight.matrix().asDiagonal() * r;
    const Eigen::RowVector3d now = r.cwiseProduct(z).colwise().sum();
    for (int k = 0; k < 3; ++k) by[k] = size[k] > 0 ? now[k] / size[k] : 0;
    p = z + p * by.asDiagonal();
    size = now;
    if (step % 10 == 9) r = rows * x;  // against rounding
    const double left = r.size() ? r.cwiseAbs().maxCoeff() : 0;
    if (left < bestLeft) {
      bestLeft = left;
      best = x;
      bestStep = step;
    } else if (step - bestStep >= kIdleMultiplierSteps) {
      break;
    }
  }
  return best;
}

JoinedSpace::Gluing JoinedSpace::gluingOf(int border, bool atStart) const {
  const auto found = gluing.find({border, atStart});
  if (found != gluing.end()) return found->second;
  const auto& point =
      layout_.points[atStart ? layout_.borders[border].startPoint : layout_.borders[border].endPoint];
  return {1, 1, point.isSingular() ? 2 * std::cos(2 * M_PI / point.quarters) : 0};
}

namespace {

/// The chart to the left or right of a border, as seen away from one of its ends.
struct Sector {
  int chart;
  Eigen::Vector2d corner, along, inward;
};

Sector sectorOf(const Layout::Border& border, bool atStart, bool left) {
  const int side = atStart == left ? 0 : 1;
  const Eigen::Vector2d &from = atStart ? border.start[side] : border.end[side],
                        &to = atStart ? border.end[side] : border.start[side];
  const Eigen::Vector2d along = (to - from) / border.length();
  const Eigen::Vector2d turned(-along[1], along[0]);
  return {border.chart[side], from, along, left ? turned : Eigen::Vector2d(-turned)};
}

/// Least-squares derivative of the surface from `origin` into a sector, along its border; none where too few
/// data determine it.
std::optional<Eigen::Vector3d> tangentIn(const Sector& sector, const std::vector<Datum>& data,
                                         const Eigen::Vector3d& origin, double radius) {
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Matrix<double, 2, 3> rhs = Eigen::Matrix<double, 2, 3>::Zero();
  int count = 0;
  for (const auto& d : data) {
    const Eigen::Vector2d away = d.parameter - sector.corner;
    const Eigen::Vector2d x(away.dot(sector.along), away.dot(sector.inward));
    if (x.minCoeff() < 0 || x.norm() > radius || x.norm() == 0) continue;
    normal += d.weight * x * x.transpose();
    rhs += d.weight * x * (d.point - origin).transpose();
    ++count;
  }
  if (count < kFewestForTangent || !(normal.determinant() > 1e-6 * std::pow(normal.trace(), 2))) return {};
  return Eigen::Vector3d((normal.inverse() * rhs).row(0));
}

}  // namespace

void JoinedSpace::alignTangents(const std::vector<std::vector<Datum>>& data) {
  gluing.clear();
  for (int p = 0; p < int(layout_.points.size()); ++p) {
    if (!layout_.points[p].isSingular()) continue;
    // Borders around the singularity, counter-clockwise: the sector to the left of each is to the right of
    // the next.
    struct Ray {
      int border;
      bool atStart;
      Sector left, right;
      Eigen::Vector3d tangent;
    };
    std::vector<Ray> rays;
    double radius = kTangentRadius;
    for (int b = 0; b < int(layout_.borders.size()); ++b)
      for (const bool atStart : {true, false}) {
        const auto& border = layout_.borders[b];
        if ((atStart ? border.startPoint : border.endPoint) != p) continue;
        radius = std::min(radius, border.length() / 2);
        rays.push_back({b, atStart, sectorOf(border, atStart, true), sectorOf(border, atStart, false), {}});
      }
    const int n = int(rays.size());
    std::vector<int> next(n, -1);
    bool known = n == layout_.points[p].quarters;
    for (int i = 0; i < n && known; ++i) {
      for (int j = 0; j < n; ++j)
        if (rays[j].right.chart == rays[i].left.chart && rays[j].right.corner == rays[i].left.corner &&
            rays[j].right.inward == rays[i].left.along)
          next[i] = j;
      const auto& origin = layout_.points[p].position;
      const auto left = tangentIn(rays[i].left, data[rays[i].left.chart], origin, radius),
                 right = tangentIn(rays[i].right, data[rays[i].right.chart], origin, radius);
      known = next[i] >= 0 && left && right;
      if (known) rays[i].tangent = (*left + *right) / 2;
    }
    if (!known) continue;
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    for (int i = 0; i < n; ++i) normal += rays[i].tangent.cross(rays[next[i]].tangent);
    normal.normalize();
    const auto area = [&](int i) { return normal.dot(rays[i].tangent.cross(rays[next[i]].tangent)); };
    for (int i = 0; i < n && known; ++i) {
      const double angle =
          std::asin(std::clamp(area(i) / (rays[i].tangent.norm() * rays[next[i]].tangent.norm()), -1.0, 1.0));
      known = angle > kSmallestAngle;
    }
    if (!known) continue;
    std::vector<int> before(n);
    for (int i = 0; i < n; ++i) before[next[i]] = i;
    for (int i = 0; i < n; ++i) {
      const double ahead = area(i), behind = area(before[i]);
      Gluing g;
      g.left = 2 * behind / (ahead + behind);
      g.right = 2 * ahead / (ahead + behind);
      const auto inPlane = [&](const Eigen::Vector3d& t) -> Eigen::Vector3d {
        return t - t.dot(normal) * normal;
      };
      const Eigen::Vector3d own = inPlane(rays[i].tangent);
      g.along =
          (g.left * rays[next[i]].tangent + g.right * rays[before[i]].tangent).dot(own) / own.squaredNorm();
      gluing[{rays[i].border, rays[i].atStart}] = g;
    }
  }
}

JoinedSpace::JoinedSpace(const Layout& layout) : layout_(layout) {
  for (const auto& corners : singularCorners()) stiffReach.emplace_back(corners.size(), kStiffReach);
}

std::vector<std::vector<Eigen::Vector2d>> JoinedSpace::singularCorners() const {
  std::vector<std::vector<Eigen::Vector2d>> result(layout_.charts.size());
  for (const auto& border : layout_.borders)
    for (const int side : {0, 1}) {
      if (layout_.points[border.startPoint].isSingular())
        result[border.chart[side]].push_back(border.start[side]);
      if (layout_.points[border.endPoint].isSingular())
        result[border.chart[side]].push_back(border.end[side]);
    }
  return result;
}

std::vector<JoinedSpace::Condition> JoinedSpace::conditions() const {
  std::vector<Condition> result;
  const auto offset = offsets();
  for (int b = 0; b < int(layout_.borders.size()); ++b) addBorder(b, offset, result);
  return result;
}

namespace {

Eigen::Vector3d middleOf(const std::vector<std::vector<Datum>>& data) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  double count = 0;
  for (const auto& chart : data)
    for (const auto& d : chart) middle += (d.point - middle) / ++count;
  return middle;
}

}  // namespace

std::optional<std::vector<SplineSurface>> JoinedSpace::leastSquares(
    const std::vector<std::vector<Datum>>& data, const Fairness& fairness, const Progress& progress) const {
  std::vector<int> all(charts.size());
  std::iota(all.begin(), all.end(), 0);
  std::vector<SplineSurface> surfaces;
  const Eigen::Vector3d middle = middleOf(data);
  for (const int c : all) {
    surfaces.push_back(charts[c].emptySurface());
    surfaces.back().poles.assign(charts[c].poles(), middle);
  }
  return leastSquares(data, fairness, all, std::move(surfaces), progress);
}

std::optional<std::vector<SplineSurface>> JoinedSpace::leastSquares(
    const std::vector<std::vector<Datum>>& data, const Fairness& fairness, const std::vector<int>& chosen,
    std::vector<SplineSurface> surfaces, const Progress& progress) const {
  const auto offset = offsets();
  const Eigen::Vector3d middle = middleOf(data);
  double extent = 0;
  for (const auto& chart : data)
    for (const auto& d : chart) extent = std::max(extent, (d.point - middle).norm());

  // The unknowns are the changes of the chosen charts' poles.
  std::vector<int> unknown(offset.back(), -1);
  int unknowns = 0;
  for (const int c : chosen)
    for (int i = offset[c]; i < offset[c + 1]; ++i) unknown[i] = unknowns++;
  Eigen::MatrixXd poles(offset.back(), 3), before(unknowns, 3);
  for (std::size_t c = 0; c < charts.size(); ++c)
    for (int i = 0; i < charts[c].poles(); ++i) {
      const int k = offset[c] + i;
      poles.row(k) = (surfaces[c].poles[i] - middle).transpose();
      if (unknown[k] >= 0) before.row(unknown[k]) = poles.row(k);
    }

  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixXd rhs = Eigen::MatrixXd::Zero(unknowns, 3);
  const auto corners = singularCorners();
  for (const int c : chosen) {
    progress.check();
    Fairness here = fairness.ofChart(c);
    for (std::size_t k = 0; k < corners[c].size(); ++k)
      here.stiff.push_back({corners[c][k], stiffReach[c][k]});
    charts[c].addNormalEquations(data[c], here, middle, unknown[offset[c]], entries, rhs);
  }
  std::vector<Condition> rows;
  for (auto& row : conditions()) {
    Eigen::RowVector3d others = Eigen::RowVector3d::Zero();
    Condition own{{}, row.weight, row.exact};
    for (const auto& [i, a] : row.terms)
      if (unknown[i] >= 0)
        own.terms.emplace_back(unknown[i], a);
      else
        others += a * poles.row(i);
    for (const auto& [i, a] : own.terms) {
      rhs.row(i) -= row.weight * a * others;
      for (const auto& [j, b] : own.terms)
        if (i >= j) entries.emplace_back(i, j, row.weight * a * b);
    }
    if (!own.terms.empty()) rows.push_back(std::move(own));
  }
  Eigen::SparseMatrix<double> matrix(unknowns, unknowns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  entries = {};
  rhs -= matrix.selfadjointView<Eigen::Lower>() * before;
  SparseSolver solver("fit");
  if (!solver.tryFactorize(matrix)) return {};
  progress.check();

  const Eigen::MatrixXd after =
      before + satisfying(rows, solver, solver.solve(rhs), kRounding * extent, progress);
  for (const int c : chosen)
    for (int i = 0; i < charts[c].poles(); ++i)
      surfaces[c].poles[i] = after.row(unknown[offset[c] + i]).transpose() + middle;
  return surfaces;
}

}  // namespace trimquad
