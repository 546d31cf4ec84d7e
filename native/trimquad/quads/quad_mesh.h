#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "trimquad/base/fixed.h"
#include "trimquad/mesh/surface_mesh.h"

namespace trimquad {

struct QuadPointId {
  int index;
  friend auto operator<=>(QuadPointId, QuadPointId) = default;
};
struct CellId {
  int index;
  friend auto operator<=>(CellId, CellId) = default;
};

/// A quad mesh that ends at the surface's boundary: full quads inside, trimmed cells along the boundary.
/// Every side of a cell is either shared by two cells or lies on the boundary.
struct QuadMesh {
  enum class PointKind {
    Grid,      ///< a grid point, inside or exactly on the boundary
    Crossing,  ///< a grid line ends on the boundary
    Corner,    ///< the boundary turns, or a feature point
    Boundary   ///< another vertex of the boundary, kept so that a cell has an area
  };
  struct Point {
    Eigen::Vector3d position;  ///< model units
    PointKind kind;
    bool border;
    int quads;  ///< full turns of 90 degrees around an interior grid point (4 where regular); 0 elsewhere
  };
  using Polygon = std::vector<QuadPointId>;  ///< counter-clockwise seen from the surface's outer side
  struct Cell {
    std::vector<Polygon> loops;  ///< the outer loop first; further ones are holes inside the cell
    std::vector<Polygon>
        simple;  ///< only with several loops or a loop that touches itself: the cell cut into simple polygons
    bool full;   ///< a whole quad with four corners
    double area;         ///< parametric, as a fraction of a whole cell
    FaceHandle chart;    ///< triangle in whose chart `corner` holds
    FixedVector corner;  ///< the cell's lower left grid point, in quads
  };
  /// A part of the surface's boundary between consecutive points of a cell.
  struct BoundaryPiece {
    CellId cell;
    QuadPointId from, to;
    std::vector<Eigen::Vector3d> polyline;  ///< ends included
  };

  std::vector<Point> points;
  std::vector<Cell> cells;
  std::vector<BoundaryPiece> boundary;
  std::vector<std::array<QuadPointId, 2>> featureEdges;  ///< sides of cells along aligned edges
  int eulerCharacteristic = 0;
  int mergedSlivers = 0;   ///< trimmed cells that went into neighbours (mergeSlivers)
  int droppedSlivers = 0;  ///< and those that would be no polygons (dropVanishingCells)
};

/// Two points that more than one side joins, if there are any: the surface is less than three quads around
/// there, and the polygons, which only know their points, are no manifold.
std::optional<std::array<QuadPointId, 2>> doubledSide(const QuadMesh& quads);

/// What the histograms of the paper's Fig. 11 count.
struct QuadMeasures {
  std::vector<double> angleDeviations;  ///< degrees, of the corners of full quads at inner points from 90
  std::vector<double> edgeLengths;      ///< model units, each edge of a full quad once
};

QuadMeasures measures(const QuadMesh& quads);

/// What report.json says about a quad mesh.
struct QuadStatistics {
  int quads = 0, trimmed = 0;
  int irregularVertices = 0;  ///< interior, other than four quads
  struct {
    double mean = 0, p95 = 0, max = 0;
  } angleDeviation;  ///< degrees, of the corners of full quads from 90 (paper, Fig. 11)
  struct {
    double mean = 0, std = 0;
  } edgeLength;  ///< model units, each edge of a full quad once
};

QuadStatistics statistics(const QuadMesh& quads);

/// Text of quads.obj: full quads under `g quads`, trimmed cells as polygons under `g trimmed`, feature edges
/// as `l` under `g feature`. Cells with holes are cut into simple polygons.
std::string writeQuadsObj(const QuadMesh& quads);

}  // namespace trimquad
