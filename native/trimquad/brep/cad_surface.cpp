#include "trimquad/brep/cad_surface.h"

#include <Eigen/Dense>
#include <Precision.hxx>
#include <Standard_Failure.hxx>
#include <algorithm>
#include <cmath>
#include <optional>

#include "trimquad/brep/occt_parts.h"
#include "trimquad/brep/surface_normal.h"
#include "trimquad/mesh/aabb_tree.h"

namespace trimquad {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kSurfaceSteps = 15;
/// How far a foot point may leave the parameter box of its triangle, in sizes of the box.
constexpr double kBoxMargin = 1;

struct Jet {
  Vector3d s, su, sv, suu = Vector3d::Zero(), suv = Vector3d::Zero(), svv = Vector3d::Zero();
};

Jet jetOf(const Geom_Surface& surface, const Vector2d& uv) {
  gp_Pnt p;
  gp_Vec su, sv, suu, svv, suv;
  try {
    surface.D2(uv.x(), uv.y(), p, su, sv, suu, svv, suv);
  } catch (const Standard_Failure&) {
    // Offsets of surfaces with creases have no second derivative there; Gauss-Newton does without.
    surface.D1(uv.x(), uv.y(), p, su, sv);
    return {vec(p.XYZ()), vec(su.XYZ()), vec(sv.XYZ())};
  }
  return {vec(p.XYZ()), vec(su.XYZ()), vec(sv.XYZ()), vec(suu.XYZ()), vec(suv.XYZ()), vec(svv.XYZ())};
}

struct Patch {
  Handle(Geom_Surface) surface;
  bool reversed;
  Vector2d low, high;  ///< where the surface can be evaluated
};

struct Chart {  ///< of one triangle
  int patch;
  std::array<Vector2d, 3> uv;
};

class CadSurface : public TrueSurface {
 public:
  CadSurface(std::vector<Patch> patches, std::vector<Chart> charts, TriangleTree tree)
      : patches_(std::move(patches)), charts_(std::move(charts)), tree_(std::move(tree)) {}

  Foot closest(const Vector3d& p) const override { return footAt(locate(p, tree_.closest(p))); }

  Foot closestFacing(const Vector3d& p, const Vector3d& facing) const override {
    const auto hit = tree_.closestFacing(p, facing);
    return footAt(locate(p, hit ? *hit : tree_.closest(p)));
  }

  Curvature curvature(const Vector3d& p) const override;

 private:
  struct Place {
    const Patch* patch;
    Vector2d uv, inside;  ///< inside: the middle of the triangle
    Jet jet;
  };

  static Foot footAt(const Place& place) {
    const Patch& patch = *place.patch;
    Vector3d normal = place.jet.su.cross(place.jet.sv);
    const double length = normal.norm();
    if (length > 1e-9 * (place.jet.su.squaredNorm() + place.jet.sv.squaredNorm()))
      normal /= length;
    else
      normal = surfaceNormal(*patch.surface, place.uv, place.inside);
    return {place.jet.s, patch.reversed ? Vector3d(-normal) : normal};
  }

  /// \param hit  the nearest point on the triangles
  Place locate(const Vector3d& p, const TriangleTree::Hit& hit) const;

  std::vector<Patch> patches_;
  std::vector<Chart> charts_;
  TriangleTree tree_;
};

/// Newton step of |S - p|^2 / 2, or Gauss-Newton's where the Hessian is not positive; zero at a pole.
Vector2d newtonStep(const Jet& jet, const Vector3d& r) {
  const Vector2d gradient(r.dot(jet.su), r.dot(jet.sv));
  const double a = jet.su.squaredNorm(), b = jet.su.dot(jet.sv), c = jet.sv.squaredNorm();
  const double ha = a + r.dot(jet.suu), hb = b + r.dot(jet.suv), hc = c + r.dot(jet.svv);
  const auto solve = [&](double x, double y, double z) -> Vector2d {
    const double determinant = x * z - y * y;
    return Vector2d(-(z * gradient.x() - y * gradient.y()), -(x * gradient.y() - y * gradient.x())) /
           determinant;
  };
  if (ha > 0 && ha * hc - hb * hb > 1e-6 * a * c && a * c > 0) return solve(ha, hb, hc);
  // Near a pole one direction has no length; the damping keeps its coordinate.
  const double damping = 1e-9 * (a + c);
  if (!(damping > 0)) return Vector2d::Zero();
  return solve(a + damping, b, c + damping);
}

CadSurface::Place CadSurface::locate(const Vector3d& p, const TriangleTree::Hit& hit) const {
  const Chart& chart = charts_[hit.triangle];
  const Patch& patch = patches_[chart.patch];
  const Vector2d inside = (chart.uv[0] + chart.uv[1] + chart.uv[2]) / 3;
  Vector2d low = chart.uv[0].cwiseMin(chart.uv[1]).cwiseMin(chart.uv[2]);
  Vector2d high = chart.uv[0].cwiseMax(chart.uv[1]).cwiseMax(chart.uv[2]);
  const Vector2d margin = kBoxMargin * (high - low);
  low = (low - margin).cwiseMax(patch.low);
  high = (high + margin).cwiseMin(patch.high).cwiseMax(low);

  Vector2d uv =
      hit.barycentric[0] * chart.uv[0] + hit.barycentric[1] * chart.uv[1] + hit.barycentric[2] * chart.uv[2];
  uv = uv.cwiseMax(low).cwiseMin(high);
  Place best{&patch, uv, inside, jetOf(*patch.surface, uv)};
  double distance = (best.jet.s - p).squaredNorm();
  Jet jet = best.jet;
  for (int step = 0; step < kSurfaceSteps; ++step) {
    const Vector2d next = (uv + newtonStep(jet, jet.s - p)).cwiseMax(low).cwiseMin(high);
    const Vector2d moved = next - uv;
    const double length = (moved.x() * jet.su + moved.y() * jet.sv).norm();
    const double size = jet.s.norm() + (jet.s - p).norm();
    uv = next;
    if (length <= 1e-15 * size) break;
    jet = jetOf(*patch.surface, uv);
    const double now = (jet.s - p).squaredNorm();
    if (now <= distance) {
      distance = now;
      best.uv = uv, best.jet = jet;
    }
    if (length <= 1e-9 * std::sqrt(now) + 1e-13 * size) break;
  }
  return best;
}

/// Principal curvatures from derivatives and the normal; nothing where these do not span the tangent plane.
std::optional<TrueSurface::Curvature> principal(const Jet& jet, const Vector3d& normal) {
  // In an orthonormal frame (x, y) of the tangent plane the shape operator is a symmetric matrix.
  Vector3d x = (jet.su.squaredNorm() >= jet.sv.squaredNorm() ? jet.su : jet.sv);
  x -= normal.dot(x) * normal;
  if (x.norm() <= 0) return {};
  x.normalize();
  const Vector3d y = normal.cross(x);
  Eigen::Matrix2d frame;  // columns: su and sv in (x, y)
  frame << x.dot(jet.su), x.dot(jet.sv), y.dot(jet.su), y.dot(jet.sv);
  Eigen::Matrix2d second;
  second << normal.dot(jet.suu), normal.dot(jet.suv), normal.dot(jet.suv), normal.dot(jet.svv);
  const double scale = jet.su.squaredNorm() + jet.sv.squaredNorm();
  if (std::abs(frame.determinant()) <= 1e-6 * scale) return {};
  const Eigen::Matrix2d inverse = frame.inverse();
  // Curvature is positive where the surface bends away from its outer side, as a sphere does.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(
      Eigen::Matrix2d(-inverse.transpose() * second * inverse));
  const auto inSpace = [&](int k) -> Vector3d {
    return eigen.eigenvectors()(0, k) * x + eigen.eigenvectors()(1, k) * y;
  };
  return TrueSurface::Curvature{inSpace(0), inSpace(1), eigen.eigenvalues()[0], eigen.eigenvalues()[1]};
}

TrueSurface::Curvature CadSurface::curvature(const Vector3d& p) const {
  const Place place = locate(p, tree_.closest(p));
  // At a pole, or along an edge at which the parametrization stands still, curvature is that of a point
  // nearby.
  Vector3d normal;
  for (const double step : {0.0, 0.02, 0.2, 1.0}) {
    const Vector2d uv = place.uv + step * (place.inside - place.uv);
    normal = surfaceNormal(*place.patch->surface, uv, place.inside);
    if (place.patch->reversed) normal = -normal;
    if (const auto found = principal(step == 0 ? place.jet : jetOf(*place.patch->surface, uv), normal))
      return *found;
  }
  const Vector3d x = normal.unitOrthogonal();
  return {x, normal.cross(x), 0, 0};
}

}  // namespace

std::shared_ptr<const TrueSurface> cadSurface(const CadModel& model, const WeldedMesh& mesh,
                                              const std::vector<int>& triangles,
                                              const std::vector<char>& reversed) {
  std::vector<int> patchOfFace(model.faces.size(), -1), pointOfVertex(mesh.vertices.size(), -1);
  std::vector<Patch> patches;
  std::vector<Chart> charts;
  std::vector<Vector3d> points;
  std::vector<std::array<int, 3>> corners;
  for (const int t : triangles) {
    const auto& triangle = mesh.triangles[t];
    int& patch = patchOfFace[triangle.face];
    if (patch < 0) {
      patch = int(patches.size());
      const CadFace& face = model.faces[triangle.face];
      Patch& entry = patches.emplace_back(Patch{face.surface, bool(reversed[triangle.face]), {}, {}});
      face.surface->Bounds(entry.low.x(), entry.high.x(), entry.low.y(), entry.high.y());
      if (face.surface->IsUPeriodic())
        entry.low.x() = -Precision::Infinite(), entry.high.x() = Precision::Infinite();
      if (face.surface->IsVPeriodic())
        entry.low.y() = -Precision::Infinite(), entry.high.y() = Precision::Infinite();
    }
    auto& corner = corners.emplace_back();
    for (int k = 0; k < 3; ++k) {
      int& point = pointOfVertex[triangle.vertex[k]];
      if (point < 0) {
        point = int(points.size());
        points.push_back(mesh.vertices[triangle.vertex[k]].point);
      }
      corner[k] = point;
    }
    charts.push_back({patch, triangle.uv});
  }
  return std::make_shared<CadSurface>(std::move(patches), std::move(charts),
                                      TriangleTree(std::move(points), std::move(corners)));
}

}  // namespace trimquad
