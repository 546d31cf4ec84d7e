#include "trimquad/spline/sheet.h"

#include <Eigen/Geometry>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>

#include "trimquad/base/error.h"

namespace trimquad {

SplineSurface::Jet Sheet::jet(const Eigen::Vector2d& x) const {
  return surface.jet(surface.wrappedU(x[0]), x[1]);
}

Eigen::Vector2d Sheet::footPoint(const Eigen::Vector3d& p, const Eigen::Vector2d& guess) const {
  Eigen::Vector2d x = surface.footPoint(p, guess);
  if (period) x[0] += *period * std::round((guess[0] - x[0]) / *period);
  return x;
}

bool Sheet::holds(const Eigen::Vector2d& x) const {
  const double rounding = 1e-9 + slack;
  return (period || (x[0] >= surface.firstU() - rounding && x[0] <= surface.lastU() + rounding)) &&
         x[1] >= surface.firstV() - rounding && x[1] <= surface.lastV() + rounding;
}

int Sheet::continuity() const {
  const auto order = [](const std::vector<double>& knots, int degree) {
    int smooth = 2;
    for (std::size_t i = degree + 1; i + degree + 1 < knots.size();) {
      std::size_t j = i;
      while (j + degree + 1 < knots.size() && knots[j] == knots[i]) ++j;
      smooth = std::min(smooth, degree - int(j - i));
      i = j;
    }
    return smooth;
  };
  const int acrossSeam = period ? surface.degreeU - 1 : 2;
  return std::min(
      {acrossSeam, order(surface.knotsU, surface.degreeU), order(surface.knotsV, surface.degreeV)});
}

std::vector<double> Sheet::knotLines(int axis, double low, double high) const {
  const auto& knots = axis == 0 ? surface.knotsU : surface.knotsV;
  std::vector<double> lines;
  const double step = axis == 0 && period ? *period : 0;
  const int from = step > 0 ? int(std::floor((low - surface.lastU()) / step)) : 0;
  const int to = step > 0 ? int(std::ceil((high - surface.firstU()) / step)) : 0;
  for (int k = from; k <= to; ++k)
    for (const double knot : knots)
      if (knot + k * step > low && knot + k * step < high) lines.push_back(knot + k * step);
  std::sort(lines.begin(), lines.end());
  constexpr double rounding = 1e-9;
  lines.erase(std::unique(lines.begin(), lines.end(), [](double x, double y) { return y - x < rounding; }),
              lines.end());
  return lines;
}

Eigen::Vector3d normal(const SplineSurface::Jet& jet) {
  return jet.su.cross(jet.sv).normalized();
}

Eigen::Vector2d inPlane(const SplineSurface::Jet& jet, const Eigen::Vector3d& way) {
  Eigen::Matrix<double, 3, 2> m;
  m << jet.su, jet.sv;
  return m.colPivHouseholderQr().solve(way);
}

SplineSurface withSeamAt(const SplineSurface& closed, double u) {
  TRIMQUAD_ASSERT(closed.closedU && u >= closed.firstU() && u < closed.lastU());
  if (u == closed.firstU()) return closed;
  const int p = closed.degreeU;
  const double period = closed.lastU() - closed.firstU();
  const std::vector<double> inner(closed.knotsU.begin() + p + 1, closed.knotsU.end() - p - 1);

  // A pole is the polar form of the curve's polynomials at degree consecutive knots, whichever knots they
  // are.
  std::vector<double> periodic{closed.firstU()};
  periodic.insert(periodic.end(), inner.begin(), inner.end());
  const int cycle = int(periodic.size());
  const auto knotAt = [&](int i) {
    const int turns = int(std::floor(double(i) / cycle));
    return periodic[i - turns * cycle] + turns * period;
  };
  const int start = int(std::upper_bound(periodic.begin(), periodic.end(), u) - periodic.begin());
  std::vector<double> knots(p + 1, u);
  const double end = u + period * (1 - 1e-14);
  for (int i = start; knotAt(i) < end; ++i) knots.push_back(knotAt(i));
  knots.insert(knots.end(), p + 1, u + period);
  const int count = int(knots.size()) - p - 1;

  SplineSurface moved = closed;
  moved.knotsU = knots;
  moved.countU = count;
  moved.poles.assign(std::size_t(count) * closed.countV, Eigen::Vector3d::Zero());
  for (int i = 0; i < count; ++i) {
    // A span that the new basis function covers, in the middle; its polynomial is one of the old curve's.
    std::vector<int> covered;
    for (int j = i; j <= i + p; ++j)
      if (knots[j + 1] > knots[j]) covered.push_back(j);
    const int j = covered[covered.size() / 2];
    const double middle = closed.wrappedU((knots[j] + knots[j + 1]) / 2);
    const double shift = period * std::round(((knots[j] + knots[j + 1]) / 2 - middle) / period);
    const int span = knotSpan(closed.knotsU, p, middle);
    for (int row = 0; row < closed.countV; ++row) {
      std::vector<Eigen::Vector3d> d(p + 1);
      for (int k = 0; k <= p; ++k) d[k] = closed.pole(span - p + k, row);
      for (int r = 1; r <= p; ++r) {
        const double x = knots[i + r] - shift;
        for (int k = p; k >= r; --k) {
          const double low = closed.knotsU[span - p + k], high = closed.knotsU[span + k - r + 1];
          const double alpha = (x - low) / (high - low);
          d[k] = (1 - alpha) * d[k - 1] + alpha * d[k];
        }
      }
      moved.poles[i + std::size_t(count) * row] = d[p];
    }
  }
  for (int row = 0; row < closed.countV; ++row)
    moved.poles[count - 1 + std::size_t(count) * row] = moved.poles[std::size_t(count) * row];
  return moved;
}

std::vector<double> crossings(const std::function<double(double)>& x, double level, double band, double a,
                              double b, int steps) {
  std::vector<double> found;
  int side = 0;
  double sideAt = a;
  for (int i = 0; i <= steps; ++i) {
    const double s = i == steps ? b : a + (b - a) * i / steps, d = x(s) - level;
    const int now = d > band ? 1 : d < -band ? -1 : 0;
    if (now == 0) continue;
    if (side != 0 && now != side) {
      double low = sideAt, high = s, dLow = x(low) - level, dHigh = d;
      // Regula falsi with the Illinois rule.
      for (int step = 0; step < 60 && high - low > 1e-15 * (b - a); ++step) {
        const double middle = low - dLow * (high - low) / (dHigh - dLow), dMiddle = x(middle) - level;
        if (dMiddle == 0) {
          low = high = middle;
        } else if ((dMiddle > 0) == (dHigh > 0)) {
          high = middle;
          dHigh = dMiddle;
          dLow /= 2;
        } else {
          low = middle;
          dLow = dMiddle;
          dHigh /= 2;
        }
        if (std::abs(dMiddle) < 1e-14 * std::max(1.0, std::abs(level))) {
          low = high = middle;
          break;
        }
      }
      found.push_back((low + high) / 2);
    }
    side = now;
    sideAt = s;
  }
  return found;
}

std::vector<double> knotCrossings(const Sheet& sheet, const std::function<Eigen::Vector2d(double)>& x,
                                  double a, double b) {
  constexpr double band = 1e-3;
  // Dense enough to separate neighbouring knot lines, from a first coarse walk.
  constexpr int coarse = 64;
  Eigen::AlignedBox<double, 2> box;
  for (int i = 0; i <= coarse; ++i) box.extend(x(a + (b - a) * i / coarse));
  std::vector<double> lines[2];
  for (int axis : {0, 1}) {
    const double slack = band + 0.1 * box.sizes()[axis];
    lines[axis] = sheet.knotLines(axis, box.min()[axis] - slack, box.max()[axis] + slack);
  }
  const int steps = std::clamp(4 * int(lines[0].size() + lines[1].size()), coarse, 1024);
  std::vector<Eigen::Vector2d> walked(steps + 1);
  for (int i = 0; i <= steps; ++i) walked[i] = x(i == steps ? b : a + (b - a) * i / steps);
  std::vector<double> found;
  for (int axis : {0, 1})
    for (const double line : lines[axis]) {
      const auto near = [&](double s) { return x(s)[axis]; };
      int last = 0;
      for (int i = 1; i <= steps; ++i) {
        const double from = walked[last][axis] - line, to = walked[i][axis] - line;
        if (std::abs(to) <= band && i < steps) continue;
        if (std::abs(from) > band && std::abs(to) > band && (from > 0) != (to > 0)) {
          const double low = a + (b - a) * last / steps, high = i == steps ? b : a + (b - a) * i / steps;
          const auto one = crossings(near, line, band, low, high, 1);
          found.insert(found.end(), one.begin(), one.end());
        }
        last = i;
      }
    }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace trimquad
