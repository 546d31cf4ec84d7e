#pragma once

#include <array>
#include <variant>
#include <vector>

#include "trimquad/mesh/parametrization.h"
#include "trimquad/mesh/region.h"

namespace trimquad {

/// A triangulation that subdivides another one, the input: each of its triangles lies in one triangle of the
/// input, each of its vertices in a vertex, edge or triangle, and the input's vertices are its first ones.
struct RefinedMesh {
  /// Where a vertex lies on the input. What it lies in is certain, the place in there rounded.
  struct Origin {
    std::variant<VertexHandle, EdgeHandle, FaceHandle> element;
    /// Of a triangle's corners, from halfedge_handle(f) on; of the start and end of an edge's halfedge 0.
    Eigen::Vector3d weights{1, 0, 0};
  };

  SurfaceMesh mesh;
  std::vector<Origin> vertexOrigin;
  std::vector<int> faceOrigin;  ///< by face: index of the input's triangle

  FaceHandle originOf(FaceHandle f) const { return FaceHandle(faceOrigin[f.idx()]); }
};

/// The input's mesh, not refined yet.
RefinedMesh unrefined(const SurfaceMesh& input);
/// The same in place, without a second copy of the mesh.
void startFrom(const SurfaceMesh& input, RefinedMesh& refined);

/// Barycentric coordinates of an origin in the closed input triangle `f`, of its corners from
/// halfedge_handle(f) on.
Eigen::Vector3d barycentric(const SurfaceMesh& input, FaceHandle f, const RefinedMesh::Origin& origin);

Eigen::Vector3d placeInSpace(const SurfaceMesh& input, const RefinedMesh::Origin& origin);

/// Whether the closure of what `outer` lies in holds what `inner` lies in.
bool closureHolds(const SurfaceMesh& input, const RefinedMesh::Origin& outer,
                  const RefinedMesh::Origin& inner);

/// The input's edge that an edge of the refined mesh is a part of, if any.
std::optional<EdgeHandle> edgeOrigin(const SurfaceMesh& input, const RefinedMesh& refined, EdgeHandle e);

/// Part of its input triangle's area that a triangle with these corners has; negative if it is turned over.
double areaInOrigin(const SurfaceMesh& input, FaceHandle origin, const RefinedMesh::Origin& a,
                    const RefinedMesh::Origin& b, const RefinedMesh::Origin& c);

/// Puts a vertex in the middle of an edge. All other elements keep their numbers; new ones come last.
VertexHandle splitInMiddle(const SurfaceMesh& input, RefinedMesh& refined, EdgeHandle e);
/// Puts a vertex in the middle of a triangle.
VertexHandle splitInMiddle(const SurfaceMesh& input, RefinedMesh& refined, FaceHandle f);

/// Takes deleted elements out of the mesh; the last ones take their numbers. Returns the new
/// handle by old vertex index; of deleted ones it says nothing.
std::vector<VertexHandle> compact(RefinedMesh& refined);

/// Moves the vertices that the input has not, each within what it lies in, where its smallest triangle is
/// small and becomes larger.
void relax(const SurfaceMesh& input, RefinedMesh& refined);

/// Image of the vertex that `h` leaves in the chart that the input map has for the triangle of `h`, in quads.
Eigen::Vector2d imageInChart(const Parametrization& map, const RefinedMesh& refined, HalfedgeHandle h);

/// The region with the refined mesh, everything else carried over. New vertices on the model's curves lie on
/// them.
Region refinedRegion(const Region& region, const std::vector<ModelCurve>& curves, const RefinedMesh& refined);

/// The pieces of the given edges of the input, ascending.
std::vector<EdgeHandle> refinedEdges(const SurfaceMesh& input, const RefinedMesh& refined,
                                     const std::vector<EdgeHandle>& edges);

}  // namespace trimquad
