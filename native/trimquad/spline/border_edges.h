#pragma once

#include <vector>

#include "trimquad/mesh/true_surface.h"
#include "trimquad/spline/corner_point.h"
#include "trimquad/spline/layout.h"
#include "trimquad/spline/spline_model.h"

namespace trimquad {

/// The sheets of one region that is cut into charts, and the lines along which they are joined.
class BorderLines {
 public:
  /// \param sheets one a chart
  BorderLines(const Layout& layout, const Sheet* sheets);

  /// A border that ends in a point of the layout.
  struct End {
    int border;
    bool atStart;
  };
  const std::vector<End>& endsAt(int point) const { return endsAt_[point]; }

  /// The border on one of its charts' sheets; s = 0 at its start.
  SheetLine line(int border, int side) const;
  double endOf(const End& end) const {
    return end.atStart ? range_[end.border].low : range_[end.border].high;
  }
  /// Moves an end of a border along it.
  void setEnd(const End& end, double s) {
    (end.atStart ? range_[end.border].low : range_[end.border].high) = s;
  }

  /// Where a curve, from `low` to `high`, passes from one side of a border's end to the other, as its feet on
  /// the sheets do, next to `t`; t where it does not.
  double placeOnCurve(const End& end, const TrueCurve& curve, double t, double low, double high) const;

  /// The border's curve from end to end along increasing parameter of its first chart, and its lines in both
  /// charts with the same parameter.
  struct Edge {
    SplineEdge edge;  ///< the vertices are left to the caller
    PlaneCurve onSheet[2];
    bool reversed;  ///< whether it starts at the border's end
  };
  /// \pre staysOnSurfaces(border)
  Edge edge(int border) const;
  /// Whether the border runs forward and within the surfaces of both its charts, its ends as they were set.
  bool staysOnSurfaces(int border) const;

 private:
  struct Range {
    double low, high;
  };
  const Layout& layout_;
  const Sheet* sheets_;
  std::vector<std::vector<End>> endsAt_;
  std::vector<Range> range_;
};

}  // namespace trimquad
