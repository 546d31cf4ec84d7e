#include "trimquad/brep/face_cells.h"

#include <algorithm>
#include <array>
#include <span>

namespace trimquad {
namespace {

/// The knot spans of one direction, with the weights that make Bézier points of poles.
struct Spans {
  std::vector<double> breaks;
  std::vector<int> first;  ///< by span: the first pole
  std::vector<std::vector<double>>
      weight;  ///< by span: of pole first + i for point k at i + (degree + 1) * k
  int degree;

  Spans(const std::vector<double>& knots, int ofDegree) : degree(ofDegree) {
    std::unique_copy(knots.begin(), knots.end(), std::back_inserter(breaks));
    std::vector<double> arguments(degree);
    for (int s = 0; s < count(); ++s) {
      const double a = breaks[s], b = breaks[s + 1];
      auto& weights = weight.emplace_back((degree + 1) * (degree + 1));
      first.push_back(0);
      for (int k = 0; k <= degree; ++k) {
        std::fill(arguments.begin(), arguments.end(), a);
        std::fill(arguments.begin(), arguments.begin() + k, b);
        first.back() = polarForm(knots, degree, 0.5 * (a + b), arguments,
                                 std::span(weights).subspan((degree + 1) * k, degree + 1));
      }
    }
  }
  int count() const { return int(breaks.size()) - 1; }
  double middle(int span) const { return 0.5 * (breaks[span] + breaks[span + 1]); }
  /// The spans that touch the interval, from the first to behind the last.
  std::array<int, 2> touched(double low, double high) const {
    const auto from = std::lower_bound(breaks.begin(), breaks.end(), low) - breaks.begin() - 1;
    const auto to = std::upper_bound(breaks.begin(), breaks.end(), high) - breaks.begin();
    return {std::clamp(int(from), 0, count()), std::clamp(int(to), 0, count())};
  }
};

/// Which of a grid's rectangles a trim reaches.
class TrimCover {
 public:
  TrimCover(const SplineFace& face, const Spans& u, const Spans& v) : u_(u), v_(v) {
    reached_.assign(u.count() * v.count(), 0);
    for (const auto& loop : face.loops) {
      auto& polygon = polygons_.emplace_back();
      for (const auto& coedge : loop) {
        markHulls(coedge.curve);
        auto poles = coedge.curve.poles;
        if (!coedge.forward) std::reverse(poles.begin(), poles.end());
        polygon.insert(polygon.end(), poles.begin(), poles.end());
      }
    }
    for (int j = 0; j < v.count(); ++j)
      for (int i = 0, known = -1; i < u.count(); ++i) {
        if (reached(i, j)) {
          known = -1;
          continue;
        }
        // No curve runs between this rectangle and the one before.
        if (known < 0) known = isInside({u.middle(i), v.middle(j)});
        reached_[i + u.count() * j] = char(known);
      }
  }
  bool reached(int i, int j) const { return reached_[i + u_.count() * j]; }

 private:
  /// The rectangles that the boxes around the curve's pieces touch.
  void markHulls(const PlaneCurve& curve) {
    for (int k = curve.degree; k < int(curve.poles.size()); ++k) {
      if (!(curve.knots[k] < curve.knots[k + 1])) continue;
      Eigen::AlignedBox2d box;
      for (int i = k - curve.degree; i <= k; ++i) box.extend(curve.poles[i]);
      const auto [fromU, toU] = u_.touched(box.min()[0], box.max()[0]);
      const auto [fromV, toV] = v_.touched(box.min()[1], box.max()[1]);
      for (int j = fromV; j < toV; ++j)
        for (int i = fromU; i < toU; ++i) reached_[i + u_.count() * j] = 1;
    }
  }
  /// For a point outside the boxes around all pieces: around it the curves wind as often as their poles, and
  /// these pass it on one side for certain.
  bool isInside(const Eigen::Vector2d& x) const {
    int turns = 0;
    for (const auto& polygon : polygons_)
      for (std::size_t k = 0; k < polygon.size(); ++k) {
        const Eigen::Vector2d &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
        if ((a[1] <= x[1]) == (b[1] <= x[1]) || x[0] > std::min(a[0], b[0])) continue;
        turns += a[1] <= x[1] ? 1 : -1;
      }
    return turns > 0;
  }

  const Spans &u_, &v_;
  std::vector<char> reached_;
  std::vector<std::vector<Eigen::Vector2d>> polygons_;
};

}  // namespace

std::vector<FaceCell> faceCells(const SplineFace& face) {
  const auto& surface = face.surface;
  const Spans u(surface.knotsU, surface.degreeU), v(surface.knotsV, surface.degreeV);
  const TrimCover cover(face, u, v);
  std::vector<FaceCell> result;
  const int across = u.degree + 1, along = v.degree + 1;
  for (int j = 0; j < v.count(); ++j)
    for (int i = 0; i < u.count(); ++i) {
      if (!cover.reached(i, j)) continue;
      auto& cell = result.emplace_back();
      std::vector<Eigen::Vector3d> columns(across * along, Eigen::Vector3d::Zero());
      for (int l = 0; l < along; ++l)
        for (int k = 0; k < across; ++k)
          for (int m = 0; m < across; ++m)
            columns[k + across * l] +=
                u.weight[i][m + across * k] * surface.pole(u.first[i] + m, v.first[j] + l);
      for (int l = 0; l < along; ++l)
        for (int k = 0; k < across; ++k) {
          Eigen::Vector3d point = Eigen::Vector3d::Zero();
          for (int m = 0; m < along; ++m) point += v.weight[j][m + along * l] * columns[k + across * m];
          cell.points.push_back(point);
          cell.box.extend(point);
        }
    }
  return result;
}

}  // namespace trimquad
