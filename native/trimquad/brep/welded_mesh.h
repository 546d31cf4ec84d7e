#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "trimquad/brep/cad_model.h"

namespace trimquad {

/// The triangles of all faces of a model, joined along the CAD edges. Two triangles are neighbours where they
/// have a side (its index) in common; sides between the same two vertices are never two different ones.
struct WeldedMesh {
  struct Vertex {
    Eigen::Vector3d point;
    std::optional<int> cadVertex;
    bool onEdge;  ///< on a CAD edge or vertex
  };
  struct Side {
    int from, to;                ///< vertices; along the CAD edge where there is one
    std::optional<int> cadEdge;  ///< the CAD edge that it is a piece of
    double first, last;          ///< its parameters at `from` and `to`
  };
  struct Triangle {
    std::array<int, 3> vertex, side;    ///< side k joins vertex k and k + 1
    std::array<Eigen::Vector2d, 3> uv;  ///< of the corners, on the face's surface
    int face;
  };
  std::vector<Vertex> vertices;
  std::vector<Side> sides;
  std::vector<Triangle> triangles;  ///< counter-clockwise about the surface's own normal
};

/// Triangulates a model's faces so that triangles are within `deflection` (model units) of them.
/// Throws Error(Input, "tessellate") naming a face that cannot be triangulated.
WeldedMesh weldedMesh(const CadModel& model, double deflection);

}  // namespace trimquad
