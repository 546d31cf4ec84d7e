#pragma once

#include <map>
#include <optional>
#include <set>
#include <vector>

#include "trimquad/spline/chart_deviation.h"
#include "trimquad/spline/spline_geometry.h"

namespace trimquad {

struct SplineVertexId {
  int index;
  friend auto operator<=>(SplineVertexId, SplineVertexId) = default;
};
struct SplineEdgeId {
  int index;
  friend auto operator<=>(SplineEdgeId, SplineEdgeId) = default;
};

struct SplineVertex {
  Eigen::Vector3d point;
  double tolerance;  ///< measured, model units, at least 1e-7
};

/// An edge from corner to corner, on the whole range of its curve. Closed loops consist of two edges or more.
struct SplineEdge {
  SpaceCurve curve;
  SplineVertexId start, end;
  double tolerance;  ///< largest distance to the surfaces' curves, measured, at least 1e-7
};

/// The use of an edge by a face: its curve in the face's parameter plane, with the edge's own parameter, same
/// range.
struct SplineCoedge {
  SplineEdgeId edge;
  bool forward;  ///< whether the loop runs along the edge's direction
  PlaneCurve curve;
};

/// A trimmed surface, of no more knot spans to a side than its loops reach. The outer loop comes first and
/// runs counter-clockwise in the parameter plane, the others clockwise. A seam edge of a closed surface
/// occurs twice in the loop, once in each direction.
struct SplineFace {
  SplineSurface surface;
  std::vector<std::vector<SplineCoedge>> loops;
  int region;
  int chart = 0;  ///< of the region's layout
};

/// Trimmed B-spline faces that share their edges: what a region, or a whole model, is rebuilt as.
struct SplineModel {
  std::vector<SplineVertex> vertices;
  std::vector<SplineEdge> edges;
  std::vector<SplineFace> faces;
  struct Shell {
    std::vector<int> faces;
    std::optional<int> solid;  ///< which solid the (closed) shell bounds
    int body = 0;              ///< the same for the shells of one solid, and for the parts of one shell
  };
  std::vector<Shell> shells;
  /// Edges between surfaces that are nearly tangent and more than a millionth of the model's diagonal apart:
  /// on the first face's surface, the second one's only within the edge's tolerance.
  int looseEdges = 0;
  std::set<int> looseRegions = {};  ///< whose surfaces these are between
  /// Regions whose common edge, where their surfaces cut each other, is farther from the curve that they end
  /// on than the tolerance: they make a sharp wedge there.
  std::set<int> strayRegions = {};
  /// By chart, of a region whose surfaces were moved to agree with others that they touch: those, whole, and
  /// how far it lies from them now.
  struct MovedSurface {
    SplineSurface surface;
    ChartDeviation deviation;
  };
  std::map<int, std::vector<MovedSurface>> moved = {};
};

}  // namespace trimquad
