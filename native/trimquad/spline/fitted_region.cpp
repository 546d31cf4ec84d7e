#include "trimquad/spline/fitted_region.h"

#include <algorithm>
#include <cmath>

#include "trimquad/mesh/triangle_surface.h"
#include "trimquad/spline/sheet.h"

namespace trimquad {
namespace {

/// The part of what is enough from which on there are bulges: they are looked for in places.
constexpr double kAway = 0.95;

}  // namespace

FittedRegion::FittedRegion(const Region& region, double tolerance, double enough)
    : region_(region), triangles_(triangleTree(region.mesh)), tolerance_(tolerance), enough_(enough) {}

Eigen::Vector3d FittedRegion::closest(const Eigen::Vector3d& p) const {
  return region_.surface ? region_.surface->closest(p).point : triangles_.closest(p).point;
}

bool FittedRegion::facesLikewise(const Eigen::Vector3d& p, const Eigen::Vector3d& normal) const {
  const auto hit = triangles_.closestFacing(p, normal);
  return hit && hit->squaredDistance <= enough_ * enough_;
}

double FittedRegion::limit() const {
  return std::max(tolerance_, kAway * enough_);
}

std::optional<Bulge> FittedRegion::farther(const SplineSurface::Jet& jet, double than) const {
  const auto hit = triangles_.closest(jet.s);
  if (hit.squaredDistance <= than * than) return {};
  const Eigen::Vector3d there = closest(jet.s), away = there - jet.s;
  double distance = away.norm();
  if (isOnBoundary(hit)) {
    // What is farther beyond the boundary than above or below it is trimmed off.
    distance = std::abs(away.dot(normal(jet)));
    if (hit.squaredDistance > 2 * distance * distance) return {};
  }
  if (!(distance > than)) return {};
  return Bulge{distance, there};
}

/// Exact: barycentric coordinates on an edge or in a corner are zero.
bool FittedRegion::isOnBoundary(const TriangleTree::Hit& hit) const {
  const auto& mesh = region_.mesh;
  const auto& t = triangles_.triangles()[hit.triangle];
  int corner = 0;
  const auto zeros = (hit.barycentric.array() == 0).count();
  if (zeros == 0) return false;
  if (zeros == 2) {
    hit.barycentric.maxCoeff(&corner);
    return mesh.is_boundary(VertexHandle(t[corner]));
  }
  hit.barycentric.minCoeff(&corner);
  const auto h = mesh.find_halfedge(VertexHandle(t[(corner + 1) % 3]), VertexHandle(t[(corner + 2) % 3]));
  return mesh.is_boundary(mesh.edge_handle(h));
}

}  // namespace trimquad
