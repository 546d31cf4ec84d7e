#pragma once

#include <Eigen/Core>
#include <Geom_Surface.hxx>

namespace trimquad {

/// The unit normal Su x Sv of a surface; where it vanishes (a pole), its limit from the direction of
/// `inside`, another parameter point of the same face. Zero where there is none at all.
Eigen::Vector3d surfaceNormal(const Geom_Surface& surface, const Eigen::Vector2d& uv,
                              const Eigen::Vector2d& inside);

}  // namespace trimquad
