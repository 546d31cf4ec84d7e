#pragma once

#include <optional>
#include <vector>

#include "trimquad/quads/planar_loop.h"

namespace trimquad {

/// A side of a polygon's outer loop led through corners of a hole, which divides it in two: the bank of the
/// hole from `exit` on to `entry` comes to the far side, the other one stays.
struct Detour {
  std::size_t side;         ///< starts at this corner of the outer loop
  std::size_t hole;         ///< by loop
  std::size_t entry, exit;  ///< corners of the hole, joined with the side's start and end
  WideQuanta length;        ///< squared, of both parts
};

/// The shortest one that crosses nothing and has no other hole between itself and the side. Where a hole and
/// the outer loop have a corner in common, only the sides beside it can be led through that hole; but if it
/// is an inner one, only the others, and the loop then comes through it twice. Exact. \param beyond  by side
/// of the outer loop: the points of the polygon beyond, if it can be led elsewhere
std::optional<Detour> shortestDetour(const SimpleLoops& cell,
                                     const std::vector<std::optional<std::vector<int>>>& beyond);

}  // namespace trimquad
