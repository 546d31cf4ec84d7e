#include "trimquad/spline/border_edges.h"

#include <algorithm>
#include <optional>

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

double BorderLines::placeOnCurve(const End& end, const TrueCurve& curve, double t, double low,
                                 double high) const {
  const SheetLine lines[] = {line(end.border, 0), line(end.border, 1)};
  struct Place {
    double t;
    Eigen::Vector2d guess[2];
    double side;  ///< quads to the first chart's side of the border; negative on the other
  };
  // A sheet may end at the border: what lies beyond has its feet on the line, and lies on the other sheet.
  const auto placeAt = [&](double at, const Place& near) {
    Place place{at, {near.guess[0], near.guess[1]}, 0};
    for (int side = 0; side < 2 && place.side == 0; ++side) {
      const Eigen::Vector2d& along = lines[side].along;
      const Eigen::Vector2d left(-along[1], along[0]);
      place.guess[side] = lines[side].sheet->footPoint(curve.point(at), near.guess[side]);
      place.side = left.dot(place.guess[side] - lines[side].start);
    }
    return place;
  };
  const Place start{t, {lines[0].at(endOf(end)), lines[1].at(endOf(end))}, 0};
  Place here = placeAt(t, start);
  constexpr int kFirstSteps = 256, kHalvings = 60;
  std::optional<Place> across;
  Place before = here, after = here;
  for (double step = (high - low) / kFirstSteps; here.side != 0 && !across; step *= 2) {
    if (before.t == low && after.t == high) return t;
    for (Place* far : {&before, &after}) {
      const double at = far == &before ? std::max(low, t - step) : std::min(high, t + step);
      const Place next = placeAt(at, *far);
      if (!across && next.side * here.side <= 0) {
        across = next;
        here = *far;
      }
      *far = next;
    }
  }
  for (int k = 0; across && across->side != 0 && k < kHalvings; ++k) {
    const Place middle = placeAt((here.t + across->t) / 2, here);
    (middle.side * here.side > 0 ? here : *across) = middle;
  }
  return across ? across->t : here.t;
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
