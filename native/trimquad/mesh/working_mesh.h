#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

#include "trimquad/mesh/divide_curves.h"
#include "trimquad/mesh/region.h"

namespace trimquad {

/// A region's mesh while its triangles change, with the operations that keep it a valid approximation of the
/// region's surface. Elements that went away stay in place, marked deleted, until `finish`.
class WorkingMesh {
 public:
  WorkingMesh(const Region& region, const RemeshOptions& options);

  SurfaceMesh mesh;
  /// Per vertex.
  std::vector<Eigen::Vector3d> normal;  ///< of the true surface
  std::vector<double> curvatureSize;    ///< longest edge that the curvature allows
  std::vector<char> onRidge;            ///< the radius of curvature is below the tolerance
  std::vector<double> size;             ///< wanted edge length
  std::vector<double> parameter;        ///< on the curve, inside one
  std::vector<std::optional<CornerId>> corner;
  std::vector<char> fixed;   ///< boundary vertices that stay
  std::vector<char> pinned;  ///< feature points: stay wherever they are
  /// Per edge.
  std::vector<std::optional<CurveId>> edgeCurve;

  /// Whether a vertex may move along the boundary at most: it is on the boundary or a feature point.
  bool isHeld(VertexHandle v) const { return mesh.is_boundary(v) || pinned[v.idx()]; }

  /// 1 for an equilateral triangle facing the side of `normal`, 0 for a degenerate one, negative for a folded
  /// one.
  static double quality(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                        const Eigen::Vector3d& normal);
  double quality(FaceHandle f) const;
  /// The worst quality around `v` if it were at `point`, leaving out triangles that also contain `except`.
  double worstAround(VertexHandle v, const Eigen::Vector3d& point,
                     VertexHandle except = VertexHandle()) const;
  double length(EdgeHandle e) const { return (mesh.calc_edge_vector(e)).norm(); }
  double wantedLength(EdgeHandle e) const;
  /// An inner edge between two boundary vertices.
  bool isChord(EdgeHandle e) const;

  /// Cuts an inner edge at the surface point nearest to its middle. With `always` false, only where that
  /// point is plainly the one between the edge's ends. Returns whether it did.
  bool splitInner(EdgeHandle e, bool always);
  VertexHandle splitBoundary(EdgeHandle e, double t, const Eigen::Vector3d& point);
  /// Puts a vertex into the middle of a triangle.
  void splitFace(FaceHandle f);

  /// The worst quality of the triangles that would change if the halfedge's start moved to its end; nothing
  /// where the collapse would change the topology.
  std::optional<double> qualityAfterCollapse(HalfedgeHandle h) const;
  void collapse(HalfedgeHandle h);

  /// Flips an inner edge where that improves the worse of its two triangles and makes no chord. Quick where
  /// neither changed since the edge was looked at last.
  bool flipIfBetter(EdgeHandle e);
  /// Moves an inner vertex towards the middle of its neighbours along the surface, if no triangle gets bad by
  /// it.
  void smooth(VertexHandle v);

  /// Wanted lengths from curvature, boundary and neighbours.
  void updateSizes();

  /// The mesh and its attributes without deleted elements; the region's surface and name stay.
  void finish(Region& region) const;

 private:
  void measureCurvature(const Eigen::Vector3d& point);  ///< of the next vertex
  VertexHandle addVertex(const Eigen::Vector3d& point, const Eigen::Vector3d& surfaceNormal);
  /// To be called when a vertex or the triangles around it changed: their sides may be flipped again.
  void disturb(VertexHandle v);
  bool isBetterFlipped(EdgeHandle e) const;
  /// The worst quality of the four triangles that splitting the halfedge's edge at `point` makes.
  double splitQuality(HalfedgeHandle h, const Eigen::Vector3d& point,
                      const Eigen::Vector3d& pointNormal) const;
  /// The true normal at a vertex, on the sheet of its triangles where several sheets of the surface meet.
  Eigen::Vector3d normalOnSheet(VertexHandle v) const;

  const TrueSurface& surface_;
  RemeshOptions options_;
  std::vector<char> settled_;  ///< by edge: it is not to be flipped as its two triangles are
};

}  // namespace trimquad
