#include "trimquad/spline/knot_lattice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace trimquad {
namespace {

constexpr double kMostParts = 64;  ///< of a segment
/// How many times wider than the one beside it a part of a lattice's line is at most.
constexpr double kGrading = 4;

double doubledArea(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Divides the parts that are wider than that many times the one before them, more closely towards it.
std::vector<double> graded(const std::vector<double>& ends, double firstLimit) {
  std::vector<double> result{ends.front()};
  double limit = firstLimit;
  for (std::size_t i = 1; i < ends.size(); ++i) {
    const double start = ends[i - 1], width = ends[i] - start;
    int halvings = 0;
    while (width * std::exp2(-halvings) > limit) ++halvings;
    for (; halvings > 0; --halvings) result.push_back(start + width * std::exp2(-halvings));
    result.push_back(ends[i]);
    limit = kGrading * (result.back() - result[result.size() - 2]);
  }
  return result;
}

std::vector<double> mirrored(std::vector<double> ends) {
  std::reverse(ends.begin(), ends.end());
  for (double& x : ends) x = -x;
  return ends;
}

/// The ends of a line's parts.
std::vector<double> parts(const SplineLine& line, int across) {
  std::vector<double> ends;
  for (int span = 0; span < line.spans(); ++span)
    for (int i = 0; i < across; ++i) ends.push_back(line.breaks[span] + i * line.width(span) / across);
  ends.push_back(line.breaks.back());
  // Across a closed line's end as well.
  const double none = std::numeric_limits<double>::infinity();
  const auto grade = [&] {
    ends = graded(ends, line.closed ? kGrading * (ends.back() - ends[ends.size() - 2]) : none);
  };
  grade();
  ends = mirrored(std::move(ends));
  grade();
  return mirrored(std::move(ends));
}

/// The parts whose middles lie in that range, from the first to the one after the last.
std::array<int, 2> partsIn(const std::vector<double>& ends, double low, double high) {
  const auto firstFrom = [&](double x) {
    int i = int(std::upper_bound(ends.begin(), ends.end(), x) - ends.begin()) - 1;
    i = std::clamp(i, 0, int(ends.size()) - 1);
    if (i + 1 < int(ends.size()) && 0.5 * (ends[i] + ends[i + 1]) < x) ++i;
    return i;
  };
  return {firstFrom(low), firstFrom(high)};
}

}  // namespace

KnotLattice::KnotLattice(const SplineSpace& space, int across)
    : u_(parts(space.u, across)), v_(parts(space.v, across)) {}

std::vector<LatticePoint> KnotLattice::in(const std::array<Eigen::Vector2d, 3>& triangle) const {
  const Eigen::Vector2d low = triangle[0].cwiseMin(triangle[1]).cwiseMin(triangle[2]),
                        high = triangle[0].cwiseMax(triangle[1]).cwiseMax(triangle[2]);
  const double area = doubledArea(triangle[1] - triangle[0], triangle[2] - triangle[0]);
  std::vector<LatticePoint> result;
  if (!(area > 0)) return result;
  const auto columns = partsIn(u_, low[0], high[0]), rows = partsIn(v_, low[1], high[1]);
  for (int j = rows[0]; j < rows[1]; ++j)
    for (int i = columns[0]; i < columns[1]; ++i) {
      const Eigen::Vector2d x(0.5 * (u_[i] + u_[i + 1]), 0.5 * (v_[j] + v_[j + 1]));
      Eigen::Vector3d b;
      for (int k = 0; k < 3; ++k)
        b[k] = doubledArea(triangle[(k + 2) % 3] - triangle[(k + 1) % 3], x - triangle[(k + 1) % 3]) / area;
      if (b.minCoeff() < 0) continue;
      result.push_back({{i, j}, b, (u_[i + 1] - u_[i]) * (v_[j + 1] - v_[j])});
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
