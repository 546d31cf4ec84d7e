#include "trimquad/spline/knot_lattice.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace trimquad {
namespace {

constexpr double kMostParts = 64;  ///< of a segment

double doubledArea(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Where the lattice's lines of one direction are, from the first one not below `low` to the last below
/// `high`.
struct LatticeLine {
  int index;
  double at, width;
};

std::vector<LatticeLine> latticeLines(const SplineLine& line, double low, double high, int across) {
  std::vector<LatticeLine> result;
  for (int span = line.spanOf(low), last = line.spanOf(high); span <= last; ++span)
    for (int i = 0; i < across; ++i) {
      const double width = line.width(span) / across, at = line.breaks[span] + (i + 0.5) * width;
      if (at >= low && at < high) result.push_back({span * across + i, at, width});
    }
  return result;
}

}  // namespace

std::vector<LatticePoint> latticePoints(const SplineSpace& space,
                                        const std::array<Eigen::Vector2d, 3>& triangle, int across) {
  const Eigen::Vector2d low = triangle[0].cwiseMin(triangle[1]).cwiseMin(triangle[2]),
                        high = triangle[0].cwiseMax(triangle[1]).cwiseMax(triangle[2]);
  const double area = doubledArea(triangle[1] - triangle[0], triangle[2] - triangle[0]);
  std::vector<LatticePoint> result;
  if (!(area > 0)) return result;
  const auto columns = latticeLines(space.u, low[0], high[0], across);
  for (const auto& row : latticeLines(space.v, low[1], high[1], across))
    for (const auto& column : columns) {
      const Eigen::Vector2d x(column.at, row.at);
      Eigen::Vector3d b;
      for (int k = 0; k < 3; ++k)
        b[k] = doubledArea(triangle[(k + 2) % 3] - triangle[(k + 1) % 3], x - triangle[(k + 1) % 3]) / area;
      if (b.minCoeff() < 0) continue;
      result.push_back({{column.index, row.index}, b, column.width * row.width});
    }
  return result;
}

int latticeParts(const SplineSpace& space, const Eigen::Vector2d& a, const Eigen::Vector2d& b, int across) {
  double parts = 1;
  for (int axis = 0; axis < 2; ++axis) {
    const SplineLine& line = axis == 0 ? space.u : space.v;
    const auto [low, high] = std::minmax(a[axis], b[axis]);
    double narrowest = line.width(line.spanOf(low));
    for (int i = line.spanOf(low); i <= line.spanOf(high); ++i)
      narrowest = std::min(narrowest, line.width(i));
    parts = std::max(parts, std::ceil(across * (high - low) / narrowest));
  }
  return int(std::min(parts, kMostParts));
}

std::vector<std::array<int, 3>> latticeCells(const std::vector<std::array<int, 3>>& chartAndIndex,
                                             int first) {
  using Entry = std::pair<std::array<int, 3>, int>;
  std::vector<Entry> entries;
  for (std::size_t i = 0; i < chartAndIndex.size(); ++i)
    entries.emplace_back(chartAndIndex[i], first + int(i));
  std::sort(entries.begin(), entries.end());
  const auto find = [&](const std::array<int, 3>& key) -> std::optional<int> {
    const auto it = std::lower_bound(entries.begin(), entries.end(), Entry{key, 0});
    if (it == entries.end() || it->first != key) return {};
    return it->second;
  };
  std::vector<std::array<int, 3>> cells;
  for (const auto& [key, sample] : entries) {
    const auto right = find({key[0], key[1] + 1, key[2]}), above = find({key[0], key[1], key[2] + 1});
    if (right && above) cells.push_back({sample, *right, *above});
  }
  return cells;
}

}  // namespace trimquad
