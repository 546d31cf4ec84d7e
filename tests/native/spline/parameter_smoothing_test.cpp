#include "trimquad/spline/parameter_smoothing.h"

#include <gtest/gtest.h>

#include <cmath>

namespace trimquad {
namespace {

constexpr int kSide = 20;

/// A square grid of samples, its squares cut in two.
std::vector<std::array<int, 3>> grid() {
  std::vector<std::array<int, 3>> cells;
  for (int j = 0; j + 1 < kSide; ++j)
    for (int i = 0; i + 1 < kSide; ++i) {
      const int a = i + kSide * j;
      cells.push_back({a, a + 1, a + kSide + 1});
      cells.push_back({a, a + kSide + 1, a + kSide});
    }
  return cells;
}

struct Moves {
  std::vector<std::optional<int>> chart = std::vector<std::optional<int>>(kSide * kSide, 0);
  std::vector<char> held = std::vector<char>(kSide * kSide, 0);
  std::vector<Eigen::Vector2d> moves;

  template <class Function>
  explicit Moves(const Function& function) {
    for (int j = 0; j < kSide; ++j)
      for (int i = 0; i < kSide; ++i) moves.push_back(function(i, j));
  }
  const Eigen::Vector2d& at(int i, int j) const { return moves[i + kSide * j]; }
};

TEST(ParameterSmoothing, whatIsTheSameEverywhereStaysAndWhatGoesToAndFroVanishes) {
  const Eigen::Vector2d all(0.3, -0.1);
  Moves moves([&](int i, int j) -> Eigen::Vector2d { return all * (1 + ((i + j) % 2 ? 1 : -1)); });
  smoothMoves(grid(), moves.chart, moves.held, moves.moves);
  EXPECT_LT((moves.at(10, 10) - all).norm(), 0.01);
}

TEST(ParameterSmoothing, movesThatVaryOverManySamplesStayAboutTheSame) {
  const auto wave = [](int i, int) { return Eigen::Vector2d(std::cos(2 * M_PI * i / kSide), 0); };
  Moves moves(wave);
  smoothMoves(grid(), moves.chart, moves.held, moves.moves);
  EXPECT_NEAR(moves.at(10, 10)[0], -1, 0.3);
}

TEST(ParameterSmoothing, heldMovesStayButReachOthersAndOtherChartsAreNotMixed) {
  Moves moves([](int i, int j) -> Eigen::Vector2d {
    return i == 10 && j == 10 ? Eigen::Vector2d(1, 0) : Eigen::Vector2d::Zero();
  });
  moves.held[10 + kSide * 10] = 1;
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i) moves.chart[i + kSide * j] = i <= 10 ? 0 : 1;
  moves.chart[5 + kSide * 5].reset();
  smoothMoves(grid(), moves.chart, moves.held, moves.moves);
  EXPECT_EQ(moves.at(10, 10), Eigen::Vector2d(1, 0));
  EXPECT_GT(moves.at(9, 10)[0], 0.1);
  EXPECT_EQ(moves.at(11, 10), Eigen::Vector2d(0, 0));
  EXPECT_EQ(moves.at(5, 5), Eigen::Vector2d(0, 0)) << "without a chart";
}

}  // namespace
}  // namespace trimquad
