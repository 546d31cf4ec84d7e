#include "support/fit_figures.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace trimquad::test {

std::pair<int, Eigen::Vector2d> footOf(const FittedSurface& fitted, const Eigen::Vector3d& p, FaceHandle f,
                                       const Eigen::Vector2d& x) {
  if (!fitted.layout) return {0, fitted.surface.footPoint(p, x)};
  const Layout& layout = *fitted.layout;
  const auto& piece = layout.pieceAt(f, x);
  const Eigen::Vector2d guess = Layout::apply(piece.toChart, layout.scale, x);
  std::pair<int, Eigen::Vector2d> best;
  double least = std::numeric_limits<double>::infinity();
  const auto visit = [&](int chart, const Eigen::Vector2d& from) {
    const auto& s = fitted.surfaces[chart];
    const Eigen::Vector2d at = s.footPoint(p, from);
    const double distance = (s.point(at[0], at[1]) - p).norm();
    if (distance < least) best = {chart, at}, least = distance;
  };
  visit(piece.chart, guess);
  for (const auto& border : layout.borders)
    for (const int side : {0, 1})
      if (border.chart[side] == piece.chart)
        visit(border.chart[1 - side],
              Layout::apply(side == 0 ? border.across : border.across.inverse(), layout.scale, guess));
  return best;
}

FitFigures figures(const FittedSurface& fitted, const Region& region, const GridMap& map) {
  FitFigures result;
  const std::vector<SplineSurface>& surfaces = fitted.layout ? fitted.surfaces : std::vector{fitted.surface};
  double extent = 0;
  for (const auto& s : surfaces) {
    result.poles += s.poles.size();
    for (const auto& p : s.poles) extent = std::max(extent, (p - surfaces[0].poles[0]).norm());
  }
  double sum = 0;
  int count = 0;
  for (const auto f : map.mesh.faces()) {
    Eigen::Vector3d p[3];
    Eigen::Vector2d x[3];
    auto h = map.mesh.halfedge_handle(f);
    for (int k = 0; k < 3; ++k, h = map.mesh.next_halfedge_handle(h)) {
      p[k] = map.mesh.point(map.mesh.from_vertex_handle(h));
      x[k] = map.scale.toQuads(map.from(h));
    }
    for (const auto& w : {Eigen::Vector3d(0.3, 0.3, 0.4), Eigen::Vector3d(0.8, 0.15, 0.05),
                          Eigen::Vector3d(0.1, 0.45, 0.45), Eigen::Vector3d(0.46, 0.08, 0.46)}) {
      const auto truly = region.surface->closest(w[0] * p[0] + w[1] * p[1] + w[2] * p[2]);
      const auto [chart, at] = footOf(fitted, truly.point, f, w[0] * x[0] + w[1] * x[1] + w[2] * x[2]);
      const auto jet = surfaces[chart].jet(at[0], at[1]);
      const double distance = (jet.s - truly.point).norm();
      result.max = std::max(result.max, distance);
      sum += distance * distance;
      ++count;
      result.folds += !(jet.su.cross(jet.sv).dot(truly.normal) > 0);
    }
  }
  result.rms = std::sqrt(sum / count);
  if (!fitted.layout) return result;
  for (const auto& border : fitted.layout->borders) {
    const auto& points = fitted.layout->points;
    const bool singular = points[border.startPoint].isSingular() || points[border.endPoint].isSingular();
    constexpr int samples = 500;
    for (int i = 0; i <= samples; ++i) {
      Eigen::Vector3d at[2], normal[2];
      for (const int side : {0, 1}) {
        const Eigen::Vector2d x = border.start[side] + (border.end[side] - border.start[side]) * i / samples;
        const auto jet = surfaces[border.chart[side]].jet(x[0], x[1]);
        at[side] = jet.s;
        normal[side] = jet.su.cross(jet.sv);
      }
      result.gap = std::max(result.gap, (at[0] - at[1]).norm() / extent);
      const double jump =
          std::atan2(normal[0].cross(normal[1]).norm(), normal[0].dot(normal[1])) * 180 / std::numbers::pi;
      double& largest = singular ? result.singularJump : result.regularJump;
      largest = std::max(largest, jump);
    }
  }
  return result;
}

}  // namespace trimquad::test
