#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "trimquad/mesh/surface_mesh.h"
#include "trimquad/mesh/true_surface.h"

namespace trimquad {

struct CurveId {
  int index;
  friend auto operator<=>(CurveId, CurveId) = default;
};
struct CornerId {
  int index;
  friend auto operator<=>(CornerId, CornerId) = default;
};

/// One piece of a model that gets a map, a quad mesh and trimmed surfaces of its own: a CAD model is cut into
/// regions along its sharp edges, a mesh into its components. Outward orientation.
struct Region {
  std::string name;
  SurfaceMesh mesh;

  /// The surface behind the triangles; null where the triangles themselves are the surface.
  std::shared_ptr<const TrueSurface> surface;

  /// Per mesh edge (by index): the model's curve that a boundary edge lies on. Every boundary edge has one.
  std::vector<std::optional<CurveId>> edgeCurve;
  /// Per vertex: the parameter on its curve where it lies inside one.
  std::vector<double> curveParameter;
  /// Per vertex: the model's corner that it is, where it ends a curve (a CAD vertex that regions share).
  std::vector<std::optional<CornerId>> corner;

  /// Per triangle: the triangle of the input mesh that it lies in, as it was read; empty for CAD models.
  std::vector<int> inputTriangle;

  /// Per triangle: whether it bridges a hole and is no part of the surface; empty where none does. Edges
  /// around a bridged hole keep their curve, though they are not on the boundary. (bridgeHoles)
  std::vector<bool> bridge;

  /// Edges that must lie on grid lines: aligned boundary edges and aligned feature edges. Ascending.
  std::vector<EdgeHandle> aligned;
  /// Vertices that must lie on grid points. Ascending.
  std::vector<VertexHandle> featurePoints;
};

/// A curve of a model, from corner to corner. A closed curve starts and ends in the same corner.
struct ModelCurve {
  std::shared_ptr<const TrueCurve> curve;
  CornerId start, end;
  std::string name;  ///< "Edge3" for a CAD edge, "loop:2" for a boundary loop of a mesh
};

struct CadOrigin;  // brep/cad_origin.h

/// A whole input, cut into regions. Curves and corners are shared: where two regions meet, the vertices of
/// both along the curve are at the same places in the same number.
struct Model {
  std::vector<Region> regions;
  std::vector<ModelCurve> curves;        ///< by CurveId
  std::vector<Eigen::Vector3d> corners;  ///< by CornerId
  struct Shell {
    std::vector<int> regions;
    std::optional<int> solid;  ///< which solid of the input the shell bounds
  };
  std::vector<Shell> shells;
  double diagonal = 0;  ///< of the bounding box, model units
  /// Whether loose faces of a CAD shape touch along edges, but make up no surface when joined there.
  bool keptApart = false;
  /// Of a CAD shape: what it was cut from, for cutting regions further (brep/region_parts.h).
  std::shared_ptr<const CadOrigin> origin = nullptr;
};

}  // namespace trimquad
