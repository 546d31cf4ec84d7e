#include "trimquad/gridmap/grid_offset.h"

#include <array>
#include <cmath>

namespace trimquad {
namespace {

/// Offsets are multiples of this part of a quad.
constexpr int kOffsets = 64;
/// Distance in quads at which closeness to a grid line counts half.
constexpr double kNear = 0.05;
/// Weight of a boundary edge by its angle to the grid lines: the cosine to this power.
constexpr int kSteepness = 16;

}  // namespace

FixedVector offsetOffBoundary(const Parametrization& map) {
  std::array<std::array<double, kOffsets>, 2> closeness{};
  for (const auto h : map.mesh.halfedges()) {
    if (map.mesh.is_boundary(h) || !map.mesh.is_boundary(map.mesh.opposite_halfedge_handle(h))) continue;
    const Eigen::Vector2d from = map.scale.toQuads(map.from(h)), along = map.scale.toQuads(map.to(h)) - from;
    const double length = along.norm();
    for (const int axis : {0, 1}) {
      const double weight = length * std::pow(std::abs(along[1 - axis]) / length, kSteepness);
      const double place = from[axis] + along[axis] / 2;
      for (int k = 0; k < kOffsets; ++k) {
        const double x = place + double(k) / kOffsets;
        closeness[axis][k] += weight / (kNear + std::abs(x - std::round(x)));
      }
    }
  }
  const auto best = [&](int axis) {
    int least = 0;
    for (int k = 1; k < kOffsets; ++k)
      if (closeness[axis][k] < closeness[axis][least]) least = k;
    return Quanta(least) * map.scale.one() / kOffsets;
  };
  return {best(0), best(1)};
}

}  // namespace trimquad
