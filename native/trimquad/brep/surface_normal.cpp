#include "trimquad/brep/surface_normal.h"

#include <Eigen/Geometry>
#include <gp_Pnt.hxx>
#include <gp_Vec.hxx>

namespace trimquad {

Eigen::Vector3d surfaceNormal(const Geom_Surface& surface, const Eigen::Vector2d& uv,
                              const Eigen::Vector2d& inside) {
  for (const double step : {0.0, 1e-5, 1e-3, 0.05, 0.5}) {
    const Eigen::Vector2d at = uv + step * (inside - uv);
    gp_Pnt p;
    gp_Vec su, sv;
    surface.D1(at.x(), at.y(), p, su, sv);
    const gp_Vec normal = su.Crossed(sv);
    const double length = normal.Magnitude();
    if (length > 1e-9 * (su.SquareMagnitude() + sv.SquareMagnitude()))
      return Eigen::Vector3d(normal.X(), normal.Y(), normal.Z()) / length;
  }
  return Eigen::Vector3d::Zero();
}

}  // namespace trimquad
