#include "trimquad/mesh/feature_points.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "trimquad/base/error.h"
#include "trimquad/mesh/aabb_tree.h"
#include "trimquad/mesh/split_triangles.h"

namespace trimquad {
namespace {

using Eigen::Vector3d;

/// A point this close to a curve or a corner lies on it, in quad edges.
constexpr double kOnCurve = 1e-3;

struct Nearest {
  int region = 0;
  FaceHandle face;
  Vector3d barycentric;
  double distance = std::numeric_limits<double>::infinity();
};

Nearest nearestTriangle(const Model& model, const Vector3d& p) {
  Nearest best;
  for (int r = 0; r < int(model.regions.size()); ++r) {
    const auto& mesh = model.regions[r].mesh;
    for (const auto f : mesh.faces()) {
      const auto h = mesh.halfedge_handle(f);
      const Vector3d &a = mesh.point(mesh.from_vertex_handle(h)), &b = mesh.point(mesh.to_vertex_handle(h)),
                     &c = mesh.point(mesh.to_vertex_handle(mesh.next_halfedge_handle(h)));
      const Vector3d w = closestOnTriangle(p, a, b, c);
      const double distance = (w[0] * a + w[1] * b + w[2] * c - p).norm();
      if (distance < best.distance) best = {r, f, w, distance};
    }
  }
  return best;
}

/// Whether the closest point of a triangle lies in one of its boundary edges.
bool onBoundaryEdge(const SurfaceMesh& mesh, const Nearest& nearest) {
  HalfedgeHandle h = mesh.halfedge_handle(nearest.face);
  for (int k = 0; k < 3; ++k, h = mesh.next_halfedge_handle(h))
    if (nearest.barycentric[(k + 2) % 3] <= 1e-6 && mesh.is_boundary(mesh.edge_handle(h))) return true;
  return false;
}

struct OnCurve {
  CurvePoint point;
  double distance;
};

/// The closest point on the boundary curves of a region.
std::optional<OnCurve> nearestOnCurves(const Model& model, const Region& region, const Vector3d& p) {
  std::optional<OnCurve> best;
  for (const auto e : region.mesh.edges()) {
    const auto& id = region.edgeCurve[e.idx()];
    if (!id) continue;
    const TrueCurve& curve = *model.curves[id->index].curve;
    for (const int side : {0, 1}) {
      const auto v = region.mesh.to_vertex_handle(region.mesh.halfedge_handle(e, side));
      if (region.corner[v.idx()]) continue;
      const double t = curve.closest(p, region.curveParameter[v.idx()]);
      const double distance = (curve.point(t) - p).norm();
      if (!best || distance < best->distance) best = {{*id, t}, distance};
    }
    const double middle = curve.closest(p, 0.5 * (curve.first() + curve.last()));
    const double distance = (curve.point(middle) - p).norm();
    if (!best || distance < best->distance) best = {{*id, middle}, distance};
  }
  return best;
}

void addFeaturePoint(Region& region, VertexHandle v) {
  auto& points = region.featurePoints;
  const auto at = std::lower_bound(points.begin(), points.end(), v);
  if (at == points.end() || *at != v) points.insert(at, v);
}

}  // namespace

std::vector<CurvePoint> pinPoints(Model& model, const FeatureOptions& options) {
  std::vector<CurvePoint> onCurves;
  for (const Vector3d& p : options.points) {
    const Nearest nearest = nearestTriangle(model, p);
    if (!(nearest.distance <= kFeaturePointReach * options.quadLength))
      throw inputError("options",
                       "a feature point is " + std::to_string(nearest.distance) +
                           " away from the surface, over half a quad; give a point on it",
                       {}, p);
    Region& region = model.regions[nearest.region];
    const Vector3d point = region.surface->closest(p).point;
    const double reach = kOnCurve * options.quadLength;
    bool inCorner = false;
    for (int c = 0; c < int(model.corners.size()); ++c) {
      if ((model.corners[c] - point).norm() > reach) continue;
      inCorner = true;
      for (auto& each : model.regions)
        for (const auto v : each.mesh.vertices())
          if (each.corner[v.idx()] == CornerId{c}) addFeaturePoint(each, v);
    }
    if (inCorner) continue;
    const auto near = nearestOnCurves(model, region, point);
    if (near && (near->distance <= reach || onBoundaryEdge(region.mesh, nearest))) {
      onCurves.push_back(near->point);
      continue;
    }
    const auto vertices = region.mesh.n_vertices();
    const VertexHandle v = insertPoint(region.mesh, nearest.face, nearest.barycentric, region.inputTriangle);
    region.mesh.set_point(v, point);
    if (region.mesh.n_vertices() > vertices) {
      region.curveParameter.push_back(0);
      region.corner.emplace_back();
      region.edgeCurve.resize(region.mesh.n_edges());
    }
    addFeaturePoint(region, v);
  }
  return onCurves;
}

void divideAt(const std::vector<CurvePoint>& points, std::vector<std::vector<double>>& division) {
  std::vector<std::vector<double>> taken(division.size());
  for (const auto& [curve, t] : points) {
    auto& parameters = division[curve.index];
    auto& fixed = taken[curve.index];
    fixed.push_back(t);
    const auto movable = [&](double s) { return std::find(fixed.begin(), fixed.end(), s) == fixed.end(); };
    auto nearest = parameters.end();
    for (auto at = parameters.begin() + 1; at + 1 < parameters.end(); ++at)
      if (movable(*at) && (nearest == parameters.end() || std::abs(*at - t) < std::abs(*nearest - t)))
        nearest = at;
    // A neighbour of the new point moves; one further on stays, or the order would change.
    const auto after = std::upper_bound(parameters.begin(), parameters.end(), t);
    if (nearest != parameters.end() && (nearest == after || nearest + 1 == after))
      *nearest = t;
    else
      parameters.insert(after, t);
  }
}

void markCurvePoints(Region& region, const std::vector<CurvePoint>& points) {
  for (const auto e : region.mesh.edges())
    for (const auto& [curve, t] : points) {
      if (region.edgeCurve[e.idx()] != curve) continue;
      for (const int side : {0, 1}) {
        const auto v = region.mesh.to_vertex_handle(region.mesh.halfedge_handle(e, side));
        if (!region.corner[v.idx()] && region.curveParameter[v.idx()] == t) addFeaturePoint(region, v);
      }
    }
}

}  // namespace trimquad
