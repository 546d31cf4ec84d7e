#include "trimquad/spline/border_edges.h"

#include <algorithm>

namespace trimquad {
namespace {

constexpr int kGapSamplesPerSpan = 8;

}  // namespace

BorderLines::BorderLines(const Layout& layout, const Sheet* sheets)
    : layout_(layout), sheets_(sheets), endsAt_(layout.points.size()) {
  for (int b = 0; b < int(layout.borders.size()); ++b) {
    const auto& border = layout.borders[b];
    range_.push_back({0, border.length()});
    endsAt_[border.startPoint].push_back({b, true});
    endsAt_[border.endPoint].push_back({b, false});
  }
}

SheetLine BorderLines::line(int border, int side) const {
  const auto& b = layout_.borders[border];
  return {sheets_ + b.chart[side], b.start[side], (b.end[side] - b.start[side]) / b.length()};
}

bool BorderLines::staysOnSurfaces(int border) const {
  const auto [low, high] = range_[border];
  if (!(low < high)) return false;
  for (int side : {0, 1}) {
    const SheetLine on = line(border, side);
    const auto& s = on.sheet->surface;
    for (const Eigen::Vector2d& x : {on.at(low), on.at(high)})
      if (x[0] < s.firstU() || x[0] > s.lastU() || x[1] < s.firstV() || x[1] > s.lastV()) return false;
  }
  return true;
}

BorderLines::Edge BorderLines::edge(int border) const {
  const SheetLine lines[] = {line(border, 0), line(border, 1)};
  const int axis = layout_.borders[border].axis(0), runs = 1 - axis;
  const auto [low, high] = range_[border];
  Edge result;
  result.reversed = lines[0].along[runs] < 0;
  const double a = lines[0].at(result.reversed ? high : low)[runs],
               b = lines[0].at(result.reversed ? low : high)[runs];
  const auto& surface = lines[0].sheet->surface;
  const double at = lines[0].start[axis];
  result.edge.curve = restricted(axis == 0 ? surface.curveAtU(at) : surface.curveAtV(at), a, b);
  for (int side : {0, 1})
    result.onSheet[side] = {
        1,
        {a, a, b, b},
        {lines[side].at(result.reversed ? high : low), lines[side].at(result.reversed ? low : high)}};
  double gap = 0;
  const int samples = kGapSamplesPerSpan * int(surface.knotsU.size() + surface.knotsV.size());
  for (int i = 0; i <= samples; ++i) {
    const double t = i == samples ? b : a + (b - a) * i / samples;
    const Eigen::Vector3d p = result.edge.curve.point(t);
    for (int side : {0, 1})
      gap = std::max(gap, (lines[side].sheet->jet(result.onSheet[side].point(t)).s - p).norm());
  }
  result.edge.tolerance = std::max(1e-7, 1.01 * gap);
  return result;
}

}  // namespace trimquad
