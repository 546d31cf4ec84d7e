#pragma once

#include <optional>

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
/// the outer loop have a corner in common, only the sides beside it can be led through that hole. Exact.
/// \param movable  by side of the outer loop
std::optional<Detour> shortestDetour(const SimpleLoops& cell, const std::vector<bool>& movable);

}  // namespace trimquad
