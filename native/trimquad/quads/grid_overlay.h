#pragma once

#include <Eigen/Core>
#include <vector>

#include "trimquad/base/progress.h"
#include "trimquad/mesh/parametrization.h"

namespace trimquad {

/// The common refinement of a triangle mesh and the integer grid of its map: every triangle cut along the
/// grid lines. A half-edge structure in flat arrays; the twin of half-edge h is h ^ 1. All of it is
/// combinatorially exact.
struct GridOverlay {
  struct Point {
    Eigen::Vector3d position;
    VertexHandle vertex;   ///< the mesh vertex it is, if any
    bool integer = false;  ///< the image is a grid point
    bool border = false;
    int degree = 0;  ///< how many of its edges lie on grid lines or on the boundary
  };
  struct Halfedge {
    int origin = -1;
    int next = -1;                ///< counter-clockwise around its piece; -1 outside the surface
    int piece = -1;               ///< -1 outside the surface
    HalfedgeHandle meshHalfedge;  ///< the halfedge it is a part of; invalid inside a triangle
    /// Image of the origin in the chart of the piece's triangle. Rounded to quanta where a grid line crosses
    /// a mesh edge (equally from both sides), so that areas of pieces still add up exactly.
    FixedVector at;
  };
  struct Edge {
    bool grid = false;    ///< lies on a grid line
    bool border = false;  ///< lies on the surface's boundary
    bool separates() const { return grid || border; }
  };
  /// The part of one triangle inside one grid cell; convex.
  struct Piece {
    FaceHandle triangle;
    FixedVector cell;       ///< lower left grid point of the cell, in quads, in the triangle's chart
    WideQuanta doubleArea;  ///< quanta squared
  };

  std::vector<Point> points;
  std::vector<Halfedge> halfedges;
  std::vector<Edge> edges;  ///< by h >> 1
  std::vector<Piece> pieces;
  /// What rounding the crossings on boundary edges adds to the sum of the pieces' areas.
  WideQuanta borderRounding = 0;

  int target(int h) const { return halfedges[h ^ 1].origin; }
  /// By piece: the cell that it is a part of. Pieces that neither grid line nor boundary separates belong to
  /// one cell; cells are numbered by their first pieces.
  std::vector<int> cellOfPiece() const;
};

/// Cuts the triangles of a valid integer grid map along all grid lines.
/// Time is linear in triangles + crossings + grid points.
GridOverlay overlayGrid(const Parametrization& map, const Progress& progress);

}  // namespace trimquad
