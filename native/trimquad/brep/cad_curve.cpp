#include "trimquad/brep/cad_curve.h"

#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <Geom_Curve.hxx>
#include <algorithm>
#include <cmath>

#include "trimquad/base/error.h"
#include "trimquad/brep/occt_parts.h"

namespace trimquad {
namespace {

using Eigen::Vector3d;

constexpr int kCurveSteps = 12;

class CadCurve : public TrueCurve {
 public:
  CadCurve(double first, double last) : first_(first), last_(last) {}
  double first() const override { return first_; }
  double last() const override { return last_; }

  /// Gauss-Newton, which needs no second derivative and converges fast for points near the curve.
  double closest(const Vector3d& p, double guess) const override {
    double t = std::clamp(guess, first_, last_);
    double best = t, distance = (point(t) - p).squaredNorm();
    for (int step = 0; step < kCurveSteps; ++step) {
      const Vector3d d = tangent(t);
      const double square = d.squaredNorm();
      if (square <= 0) break;
      const double next = std::clamp(t + (p - point(t)).dot(d) / square, first_, last_);
      const bool settled = std::abs(next - t) <= 1e-14 * (last_ - first_);
      t = next;
      if (const double now = (point(t) - p).squaredNorm(); now < distance) best = t, distance = now;
      if (settled) break;
    }
    return best;
  }

 private:
  double first_, last_;
};

class SpaceEdge : public CadCurve {
 public:
  SpaceEdge(const Handle(Geom_Curve) & curve, double first, double last)
      : CadCurve(first, last), curve_(curve) {}
  Vector3d point(double t) const override { return vec(curve_->Value(t).XYZ()); }
  Vector3d tangent(double t) const override {
    gp_Pnt p;
    gp_Vec d;
    curve_->D1(t, p, d);
    return vec(d.XYZ());
  }

 private:
  Handle(Geom_Curve) curve_;
};

class SurfaceEdge : public CadCurve {
 public:
  SurfaceEdge(const Handle(Geom2d_Curve) & curve, const Handle(Geom_Surface) & surface, double first,
              double last)
      : CadCurve(first, last), curve_(curve), surface_(surface) {}
  Vector3d point(double t) const override {
    const gp_Pnt2d uv = curve_->Value(t);
    return vec(surface_->Value(uv.X(), uv.Y()).XYZ());
  }
  Vector3d tangent(double t) const override {
    gp_Pnt2d uv;
    gp_Vec2d d;
    gp_Pnt p;
    gp_Vec su, sv;
    curve_->D1(t, uv, d);
    surface_->D1(uv.X(), uv.Y(), p, su, sv);
    return d.X() * vec(su.XYZ()) + d.Y() * vec(sv.XYZ());
  }

 private:
  Handle(Geom2d_Curve) curve_;
  Handle(Geom_Surface) surface_;
};

}  // namespace

std::shared_ptr<const TrueCurve> cadCurve(const CadEdge& edge) {
  double first = 0, last = 0;
  if (const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge.edge, first, last); !curve.IsNull())
    return std::make_shared<SpaceEdge>(curve, first, last);
  Handle(Geom2d_Curve) flat;
  Handle(Geom_Surface) surface;
  TopLoc_Location location;
  BRep_Tool::CurveOnSurface(edge.edge, flat, surface, location, first, last);
  if (flat.IsNull() || surface.IsNull())
    throw inputError("tessellate", "an edge has no curve; repair the shape", edge.name);
  if (!location.IsIdentity())
    surface = Handle(Geom_Surface)::DownCast(surface->Transformed(location.Transformation()));
  return std::make_shared<SurfaceEdge>(flat, surface, first, last);
}

}  // namespace trimquad
