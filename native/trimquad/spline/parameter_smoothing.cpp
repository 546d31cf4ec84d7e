#include "trimquad/spline/parameter_smoothing.h"

namespace trimquad {
namespace {

/// Of averaging: each widens what a move spreads over by about one sample squared.
constexpr int kRounds = 12;

}  // namespace

void smoothMoves(const std::vector<std::array<int, 3>>& cells, const std::vector<std::optional<int>>& chart,
                 const std::vector<char>& held, std::vector<Eigen::Vector2d>& moves) {
  const auto isLink = [&](int i, int j) { return chart[i] && chart[i] == chart[j]; };
  std::vector<int> links(moves.size(), 0);
  for (const auto& cell : cells)
    for (int k = 0; k < 3; ++k)
      if (const int i = cell[k], j = cell[(k + 1) % 3]; isLink(i, j)) {
        ++links[i];
        ++links[j];
      }
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Eigen::Vector2d> sum(moves.size(), Eigen::Vector2d::Zero());
    for (const auto& cell : cells)
      for (int k = 0; k < 3; ++k)
        if (const int i = cell[k], j = cell[(k + 1) % 3]; isLink(i, j)) {
          sum[i] += moves[j];
          sum[j] += moves[i];
        }
    for (std::size_t i = 0; i < moves.size(); ++i)
      if (!held[i] && links[i] > 0) moves[i] = 0.5 * (moves[i] + sum[i] / double(links[i]));
  }
}

}  // namespace trimquad
