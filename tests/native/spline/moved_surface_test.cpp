#include "trimquad/spline/moved_surface.h"

#include <gtest/gtest.h>

#include "support/trim_samples.h"

namespace trimquad {
namespace {

using namespace test;

constexpr double kError = 1e-6, kFade = 1;
constexpr int kMaxPoles = 3000;

SplineSurface sheet() {
  return interpolated(wavy, -1, 11, 6, -1, 7, 4);
}

/// Up by `height` along the line y = 3.
std::vector<SurfaceMove> movesOnLine(const std::function<double(double)>& height) {
  std::vector<SurfaceMove> moves;
  constexpr int kSamples = 400;
  for (int i = 0; i <= kSamples; ++i) {
    const double x = 10.0 * i / kSamples;
    moves.push_back({{x, 3}, {0, 0, height(x)}, {1, 0}, 10.0 / kSamples, kError});
  }
  return moves;
}

double largestMiss(const SplineSurface& moved, const std::vector<SurfaceMove>& moves) {
  const auto before = sheet();
  double largest = 0;
  for (const auto& move : moves)
    largest = std::max(
        largest,
        (moved.point(move.at[0], move.at[1]) - before.point(move.at[0], move.at[1]) - move.by).norm());
  return largest;
}

double wave(double x) {
  return 1e-3 * std::sin(2 * x);
}

TEST(MovedSurface, followsSmoothMovesAndRestsFarAway) {
  const auto moves = movesOnLine(wave);
  const auto moved = movedSurface(sheet(), moves, kFade, kMaxPoles, Progress());
  ASSERT_TRUE(moved);
  EXPECT_LE(largestMiss(*moved, moves), 1.01 * kError);
  EXPECT_LE(moved->countV, sheet().countV) << "the moves vary along u only";
  for (double x = 0; x <= 10; x += 0.3)
    for (const double y : {-1.0, 7.0}) EXPECT_LE((moved->point(x, y) - sheet().point(x, y)).norm(), 1e-4);
}

TEST(MovedSurface, comesCloseToMovesWithASmallStep) {
  const auto moves = movesOnLine([](double x) { return wave(x) + (x > 4.03 ? 4e-5 : 0); });
  const auto moved = movedSurface(sheet(), moves, kFade, kMaxPoles, Progress());
  ASSERT_TRUE(moved);
  EXPECT_LE(largestMiss(*moved, moves), 5e-5);
}

TEST(MovedSurface, givesUpOnRoughMoves) {
  EXPECT_FALSE(movedSurface(sheet(), movesOnLine([](double x) { return x > 4.03 ? 1e-3 : 0; }), kFade,
                            kMaxPoles, Progress()));
}

}  // namespace
}  // namespace trimquad
