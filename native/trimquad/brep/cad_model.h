#pragma once

#include <Eigen/Core>
#include <Geom_Surface.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <optional>
#include <string>
#include <vector>

#include "trimquad/brep/shape.h"

namespace trimquad {

struct CadFace {
  TopoDS_Face face;  ///< oriented forward: along its surface's own normal
  Handle(Geom_Surface) surface;
  bool reversed;             ///< whether the shape's outside is against the surface's own normal
  std::optional<int> solid;  ///< the solid that it bounds
  std::string name;          ///< "Face3"; so are all parts of a face that was divided
};

struct CadEdge {
  TopoDS_Edge edge;  ///< oriented forward: along its curve
  int start, end;    ///< vertices
  bool degenerate;   ///< shrunk to a point: the pole of a sphere
  std::string name;  ///< "Edge3"; "Face3" of a crease across that face
};

/// The faces, edges and vertices of a shape with their connections, in OpenCASCADE's own order.
struct CadModel {
  TopoDS_Shape shape;  ///< a copy of its own, which may be meshed; geometry is shared with the original
  std::vector<CadFace> faces;
  std::vector<CadEdge> edges;
  std::vector<Eigen::Vector3d> vertices;
  bool sewn = false;
  TopTools_IndexedMapOfShape edgeNumbers;  ///< from 1
  /// By the number in a name ("Edge3" is at 2): what became of it here. Sewing makes one edge of two, and
  /// several of one; so does dividing faces.
  std::vector<std::vector<int>> edgesNamed, verticesNamed;

  int edgeIndex(const TopoDS_Shape& edge) const { return edgeNumbers.FindIndex(edge) - 1; }
};

/// Faces are divided where their surfaces have creases, see dividedAtCreases(). Those that touch along edges
/// without sharing them, as in many IGES files, are sewn first (unless they belong to a solid), where they
/// are no further apart than `gap` times the shape's diagonal; 0 leaves them apart. Throws Error(Input,
/// "tessellate") for edges without vertices and faces without a surface.
CadModel cadModel(const Shape& shape, double gap);

}  // namespace trimquad
