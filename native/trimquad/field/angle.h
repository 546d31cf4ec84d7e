#pragma once

#include <numbers>

namespace trimquad {

inline constexpr double kQuarterTurn = std::numbers::pi / 2;  ///< radians

}  // namespace trimquad
