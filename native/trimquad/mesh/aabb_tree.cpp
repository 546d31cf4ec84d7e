#include "trimquad/mesh/aabb_tree.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <numeric>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

using Eigen::Vector3d;

constexpr int kLeafSize = 4;
constexpr double kAnywhere = std::numeric_limits<double>::infinity();
/// Median splits halve the number of triangles, so that 64 levels hold any number of them.
constexpr int kStackSize = 64;

/// Share of the way from a to b at which the segment is closest to p.
double closestOnSegment(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
  const Vector3d d = b - a;
  const double square = d.squaredNorm();
  return square > 0 ? std::clamp((p - a).dot(d) / square, 0.0, 1.0) : 0.0;
}

Vector3d closestOnLongestSide(const Vector3d& p, const std::array<Vector3d, 3>& corner) {
  int longest = 0;
  double square = -1;
  for (int k = 0; k < 3; ++k) {
    const double s = (corner[(k + 1) % 3] - corner[k]).squaredNorm();
    if (s > square) square = s, longest = k;
  }
  const double t = closestOnSegment(p, corner[longest], corner[(longest + 1) % 3]);
  Vector3d barycentric = Vector3d::Zero();
  barycentric[longest] = 1 - t;
  barycentric[(longest + 1) % 3] = t;
  return barycentric;
}

double squaredDistanceToBox(const Vector3d& p, const Vector3d& low, const Vector3d& high) {
  return (low - p).cwiseMax(p - high).cwiseMax(0.0).squaredNorm();
}

}  // namespace

Vector3d closestOnTriangle(const Vector3d& p, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const Vector3d bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const Vector3d cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};

  const double wa = d3 * d6 - d5 * d4, wb = d5 * d2 - d1 * d6, wc = d1 * d4 - d3 * d2;
  const double sum = wa + wb + wc;  // four times the squared area
  if (!(sum > 1e-30 * ab.squaredNorm() * ac.squaredNorm())) return closestOnLongestSide(p, {a, b, c});
  if (wc <= 0 && d1 >= 0 && d3 <= 0) {
    const double t = d1 / (d1 - d3);
    return {1 - t, t, 0};
  }
  if (wb <= 0 && d2 >= 0 && d6 <= 0) {
    const double t = d2 / (d2 - d6);
    return {1 - t, 0, t};
  }
  if (wa <= 0 && d4 >= d3 && d5 >= d6) {
    const double t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - t, t};
  }
  // Rounding can leave a weight slightly negative on a needle.
  const Vector3d weights = Vector3d(wa, wb, wc).cwiseMax(0.0);
  return weights / weights.sum();
}

TriangleTree::TriangleTree(std::vector<Vector3d> points, std::vector<std::array<int, 3>> triangles)
    : points_(std::move(points)), triangles_(std::move(triangles)), order_(triangles_.size()) {
  if (triangles_.empty())
    throw inputError("tessellate", "there are no triangles to search for closest points");
  std::vector<Vector3d> centers;
  centers.reserve(triangles_.size());
  for (const auto& t : triangles_) centers.push_back((points_[t[0]] + points_[t[1]] + points_[t[2]]) / 3);
  std::iota(order_.begin(), order_.end(), 0);
  nodes_.reserve(triangles_.size());
  build(0, int(order_.size()), centers);
}

void TriangleTree::build(int first, int last, const std::vector<Vector3d>& centers) {
  const double infinity = std::numeric_limits<double>::infinity();
  Vector3d low = Vector3d::Constant(infinity), high = -low;
  Vector3d centerLow = low, centerHigh = high;
  for (int i = first; i < last; ++i) {
    for (const int v : triangles_[order_[i]]) {
      low = low.cwiseMin(points_[v]);
      high = high.cwiseMax(points_[v]);
    }
    centerLow = centerLow.cwiseMin(centers[order_[i]]);
    centerHigh = centerHigh.cwiseMax(centers[order_[i]]);
  }
  const int node = int(nodes_.size());
  nodes_.push_back({low, high, first, last - first});
  if (last - first <= kLeafSize) return;

  int axis = 0;
  (centerHigh - centerLow).maxCoeff(&axis);
  const int middle = first + (last - first) / 2;
  std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last, [&](int a, int b) {
    return centers[a][axis] != centers[b][axis] ? centers[a][axis] < centers[b][axis] : a < b;
  });
  build(first, middle, centers);
  const int second = int(nodes_.size());
  build(middle, last, centers);
  nodes_[node].first = second;
  nodes_[node].count = 0;
}

template <typename Accept>
std::optional<TriangleTree::Hit> TriangleTree::search(const Vector3d& p, double squaredDistance,
                                                      const Accept& accept) const {
  struct Entry {
    int node;
    double squaredDistance;
  };
  std::array<Entry, kStackSize> stack;
  int depth = 0;
  stack[depth++] = {0, squaredDistanceToBox(p, nodes_[0].low, nodes_[0].high)};
  Hit best{-1, p, Vector3d::Zero(), squaredDistance};
  while (depth > 0) {
    const Entry entry = stack[--depth];
    if (best.triangle < 0 ? entry.squaredDistance > best.squaredDistance
                          : entry.squaredDistance >= best.squaredDistance)
      continue;
    const Node& node = nodes_[entry.node];
    for (int i = node.first; i < node.first + node.count; ++i) {
      const auto& t = triangles_[order_[i]];
      const Vector3d &a = points_[t[0]], &b = points_[t[1]], &c = points_[t[2]];
      if (!accept(a, b, c)) continue;
      const Vector3d barycentric = closestOnTriangle(p, a, b, c);
      const Vector3d point = barycentric[0] * a + barycentric[1] * b + barycentric[2] * c;
      const double squared = (point - p).squaredNorm();
      // The first one counts even if the distance is not a number.
      if (best.triangle < 0 ? !(squared > best.squaredDistance) : squared < best.squaredDistance)
        best = {order_[i], point, barycentric, squared};
    }
    if (node.count > 0) continue;
    Entry near{entry.node + 1, 0}, far{node.first, 0};
    near.squaredDistance = squaredDistanceToBox(p, nodes_[near.node].low, nodes_[near.node].high);
    far.squaredDistance = squaredDistanceToBox(p, nodes_[far.node].low, nodes_[far.node].high);
    if (far.squaredDistance < near.squaredDistance) std::swap(near, far);
    stack[depth++] = far;
    stack[depth++] = near;
  }
  if (best.triangle < 0) return std::nullopt;
  return best;
}

TriangleTree::Hit TriangleTree::closest(const Vector3d& p) const {
  return *search(p, kAnywhere, [](const Vector3d&, const Vector3d&, const Vector3d&) { return true; });
}

std::optional<TriangleTree::Hit> TriangleTree::closestFacing(const Vector3d& p,
                                                             const Vector3d& facing) const {
  if (facing.isZero(0)) return std::nullopt;  // which no triangle faces, as a search through all would find
  return search(p, kAnywhere, [&](const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    return (b - a).cross(c - a).dot(facing) > 0;
  });
}

std::optional<TriangleTree::Hit> TriangleTree::closestFacing(const Vector3d& p, const Vector3d& facing,
                                                             double distance) const {
  return search(p, distance * distance, [&](const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    const Vector3d normal = (b - a).cross(c - a);
    return normal.dot(facing) > M_SQRT1_2 * normal.norm();
  });
}

}  // namespace trimquad
