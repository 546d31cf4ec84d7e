#pragma once

#include <optional>
#include <vector>

#include "trimquad/base/progress.h"
#include "trimquad/gridmap/grid_map.h"

namespace trimquad {

/// A region's grid map cut into charts: pieces that lie in the plane one to one, singularities on their
/// borders only. Cut along grid lines, so that neighbouring charts differ by a quarter-turn rotation and a
/// whole translation. Two charts that touch are different ones: none borders itself.
struct Layout {
  /// A place where charts meet, or where a border between charts ends.
  struct Point {
    Eigen::Vector3d position;  ///< on the mesh
    int quarters = 4;          ///< quarter turns around an interior point; 0 on the surface's boundary
    VertexHandle vertex;       ///< the mesh vertex it is, if any
    HalfedgeHandle
        halfedge;     ///< the inner halfedge of the boundary that it lies in, if it does and is no vertex
    double part = 0;  ///< how far along the halfedge, 0..1
    bool inner() const { return quarters != 0; }
    bool isSingular() const { return inner() && quarters != 4; }
  };

  /// A straight stretch of a grid line between two charts, directed so that the first one lies to its left.
  struct Border {
    int chart[2];
    Eigen::Vector2d start[2], end[2];  ///< by chart, in its plane, quads
    Transition across;                 ///< from the plane of the first chart to that of the second
    int startPoint, endPoint;
    bool feature = false;  ///< an aligned line, across which the surface may bend

    /// The axis along which the line is constant, in the plane of a side's chart: 0 for u.
    int axis(int side) const { return start[side][0] == end[side][0] ? 0 : 1; }
    double length() const { return (end[0] - start[0]).lpNorm<1>(); }
  };

  /// A vertex of the surface's boundary, or a point of it where charts meet.
  struct BoundaryPoint {
    VertexHandle vertex;       ///< invalid inside a mesh edge
    std::optional<int> point;  ///< of `points`, where charts meet
    Eigen::Vector2d at;        ///< in the chart's plane, quads
    HalfedgeHandle halfedge;   ///< inner, of the boundary edge that follows in the loop
    double part = 0;           ///< how far along `halfedge` the point lies
  };

  /// A stretch of a chart's outline: a border, or a part of the surface's boundary between points where
  /// charts meet (or a whole loop of it).
  struct Stretch {
    std::optional<int> border;
    bool forward = true;                  ///< whether the outline runs along the border's direction
    std::vector<BoundaryPoint> boundary;  ///< both ends included
    bool closed = false;                  ///< a whole loop of the surface's boundary
  };

  struct Chart {
    Eigen::Vector2d low, high;  ///< bounding box in its plane, quads
    Eigen::Vector2d boundaryLow,
        boundaryHigh;  ///< of the surface's boundary in it; low > high where there is none
    std::vector<std::vector<Stretch>> loops;  ///< with the chart on the left
    int cells = 0;
  };

  /// The part of a triangle inside one cell.
  struct Piece {
    FixedVector cell;  ///< lower left corner in the triangle's chart, quads
    int chart;
    Transition toChart;  ///< from the triangle's chart
  };

  FixedScale scale;
  std::vector<Point> points;
  std::vector<Border> borders;
  std::vector<Chart> charts;
  std::vector<std::vector<Piece>> pieces;  ///< by triangle

  /// Change of coordinates in quads.
  static Eigen::Vector2d apply(const Transition& t, const FixedScale& scale, const Eigen::Vector2d& x);
  /// The piece of a triangle that holds x, in quads in the triangle's chart; the nearest one where rounding
  /// leaves it outside of all.
  const Piece& pieceAt(FaceHandle f, const Eigen::Vector2d& x) const;
};

/// Few charts: the separatrices of all singularities, each until it meets another or the boundary, and then
/// charts joined as long as their union lies in the plane one to one and fills a good part of its bounding
/// box. All decisions are exact. Throws Error(Stage, "fit") where there is no such layout: around a
/// singularity with less than a half turn.
/// \param bisections by round: indices of charts of the round before that are cut in two where the surface
/// bends most
Layout layout(const GridMap& map, const std::vector<std::vector<int>>& bisections, const Progress& progress);

}  // namespace trimquad
