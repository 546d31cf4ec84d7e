#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "trimquad/field/cross_field.h"
#include "trimquad/mesh/read_mesh.h"

namespace trimquad {

/// Directions as a file lists them.
struct FieldFile {
  std::string name;  ///< for messages
  int symmetry = 1;  ///< directions per element: 1, 2 or 4, a quarter turn apart where there are 4
  std::vector<Eigen::Vector3d> direction;  ///< `symmetry` of them per element; lengths do not matter
  std::vector<double> weight;              ///< by element, in [0, 1]
  std::vector<Eigen::Vector3d> point;      ///< by element: where it holds; empty for one per face or vertex

  int count() const { return int(weight.size()); }
};

/// Reads a direction field:
/// - .rawfield (Directional, libigl): a line `N count`, then per face N vectors on a line; N is 1, 2 or 4;
/// - .rosy: a line with the count, a line with N, then per face one vector on a line;
/// - any other name, TrimQuad's own: per face or per vertex of the mesh a line `dx dy dz [weight]`, or
/// anywhere
///   on the surface `x y z dx dy dz [weight]`; # begins a comment.
/// Throws Error(Input, "read") with the line for what does not follow the format.
FieldFile readField(const std::filesystem::path& path);

/// One direction per triangle of a mesh, as it was read. Of several directions, and of those of a triangle's
/// corners, the cross is taken that fits all of them best: the mean of their fourth powers. Source: F.
/// Knoeppel et al., Globally Optimal Direction Fields, SIGGRAPH 2013. Throws Error(Input, "options") where
/// the count is neither that of the faces nor that of the vertices.
FieldGuidance triangleDirections(const FieldFile& field, const MeshFile& mesh);

/// Directions of the input's triangles on those of a region (by Region::inputTriangle).
FieldGuidance guidanceOf(const Region& region, const FieldGuidance& byInputTriangle);

/// A field given at points, on the triangles of a region: each takes the nearest point's.
FieldGuidance guidanceOf(const Region& region, const FieldFile& field);

}  // namespace trimquad
