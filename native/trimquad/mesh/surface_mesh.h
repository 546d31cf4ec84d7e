#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
// clang-format off: EigenVectorT.hh specialises templates of the mesh header without including it
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/Geometry/EigenVectorT.hh>
// clang-format on
#include <array>
#include <vector>

namespace trimquad {

struct SurfaceMeshTraits : OpenMesh::DefaultTraits {
  using Point = Eigen::Vector3d;
  using Normal = Eigen::Vector3d;
  using TexCoord2D = Eigen::Vector2d;
  VertexAttributes(OpenMesh::Attributes::Status);
  HalfedgeAttributes(OpenMesh::Attributes::PrevHalfedge | OpenMesh::Attributes::Status);
  EdgeAttributes(OpenMesh::Attributes::Status);
  FaceAttributes(OpenMesh::Attributes::Status);
};

/// A manifold, consistently oriented triangle mesh; positions in model units.
using SurfaceMesh = OpenMesh::TriMesh_ArrayKernelT<SurfaceMeshTraits>;

using VertexHandle = OpenMesh::VertexHandle;
using HalfedgeHandle = OpenMesh::HalfedgeHandle;
using EdgeHandle = OpenMesh::EdgeHandle;
using FaceHandle = OpenMesh::FaceHandle;

/// Triangles as indices, before (or without) connectivity.
struct TriangleSoup {
  std::vector<Eigen::Vector3d> points;
  std::vector<std::array<int, 3>> triangles;
};

/// The mesh of `soup` with the same vertex and face numbers.
/// Throws Error(Input) where the triangles are not an oriented manifold.
SurfaceMesh buildSurfaceMesh(const TriangleSoup& soup);

/// The boundary loops, each a closed walk of boundary halfedges (their face is invalid) in `next` order.
/// Ordered by their smallest halfedge, which comes first.
std::vector<std::vector<HalfedgeHandle>> boundaryLoops(const SurfaceMesh& mesh);

/// V - E + F.
int eulerCharacteristic(const SurfaceMesh& mesh);

double surfaceArea(const SurfaceMesh& mesh);

/// Interior angle of the triangle of `h` at the vertex that `h` leaves.
double cornerAngle(const SurfaceMesh& mesh, HalfedgeHandle h);

}  // namespace trimquad
