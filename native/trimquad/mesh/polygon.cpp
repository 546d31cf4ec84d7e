#include "trimquad/mesh/polygon.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <numeric>

namespace trimquad {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Below this share of the squared circumference a polygon has no area.
constexpr double kNoArea = 1e-24;

double cross(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// The polygon seen along its normal (Newell), counter-clockwise; empty if it has no area.
std::vector<Vector2d> meanPlaneImage(std::span<const Vector3d> polygon) {
  Vector3d normal = Vector3d::Zero();
  double circumference = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector3d a = polygon[i] - polygon[0], b = polygon[(i + 1) % polygon.size()] - polygon[0];
    normal += a.cross(b);
    circumference += (b - a).norm();
  }
  if (!(normal.squaredNorm() > kNoArea * circumference * circumference * circumference * circumference))
    return {};
  normal.normalize();
  const Vector3d u = normal.unitOrthogonal(), v = normal.cross(u);
  std::vector<Vector2d> image;
  for (const Vector3d& p : polygon) image.emplace_back(u.dot(p - polygon[0]), v.dot(p - polygon[0]));
  return image;
}

class EarClipping {
 public:
  EarClipping(std::span<const Vector3d> polygon, const std::vector<Vector2d>& image)
      : polygon_(polygon), image_(image), ring_(polygon.size()), diagonal_(polygon.size()) {
    std::iota(ring_.begin(), ring_.end(), 0);
  }

  std::optional<std::vector<std::array<int, 3>>> run() {
    std::vector<std::array<int, 3>> triangles;
    rateAll();
    while (ring_.size() > 3) {
      int ear = best();
      if (diagonal_[ring_[ear]] == kNoEar) {
        rateAll();  // a corner that lay in an ear may be gone by now
        ear = best();
        if (diagonal_[ring_[ear]] == kNoEar) return std::nullopt;
      }
      const int n = int(ring_.size());
      triangles.push_back({ring_[(ear + n - 1) % n], ring_[ear], ring_[(ear + 1) % n]});
      ring_.erase(ring_.begin() + ear);
      rate((ear + n - 2) % (n - 1));
      rate(ear % (n - 1));
    }
    if (cross(image_[ring_[0]], image_[ring_[1]], image_[ring_[2]]) < 0) return std::nullopt;
    triangles.push_back({ring_[0], ring_[1], ring_[2]});
    return triangles;
  }

 private:
  static constexpr double kNoEar = std::numeric_limits<double>::infinity();

  int best() const {
    int ear = 0;
    for (int i = 1; i < int(ring_.size()); ++i)
      if (diagonal_[ring_[i]] < diagonal_[ring_[ear]]) ear = i;
    return ear;
  }
  void rateAll() {
    for (int i = 0; i < int(ring_.size()); ++i) rate(i);
  }
  /// Squared length of the diagonal that cuts off corner i of the ring, if it lies inside.
  void rate(int i) {
    const int n = int(ring_.size());
    const int a = ring_[(i + n - 1) % n], b = ring_[i], c = ring_[(i + 1) % n];
    diagonal_[b] = kNoEar;
    if (cross(image_[a], image_[b], image_[c]) <= 0) return;
    for (const int p : ring_) {
      const Vector2d& x = image_[p];
      if (x == image_[a] || x == image_[b] || x == image_[c]) continue;
      if (cross(image_[a], image_[b], x) >= 0 && cross(image_[b], image_[c], x) >= 0 &&
          cross(image_[c], image_[a], x) >= 0)
        return;
    }
    diagonal_[b] = (polygon_[c] - polygon_[a]).squaredNorm();
  }

  std::span<const Vector3d> polygon_;
  const std::vector<Vector2d>& image_;
  std::vector<int> ring_;         ///< the corners that are left, in order
  std::vector<double> diagonal_;  ///< by corner
};

}  // namespace

std::optional<std::vector<std::array<int, 3>>> triangulatePolygon(std::span<const Vector3d> polygon) {
  const int n = int(polygon.size());
  if (n == 3) return {{{0, 1, 2}}};
  const std::vector<Vector2d> image = meanPlaneImage(polygon);
  if (n == 4 && !image.empty() && cross(image[0], image[1], image[2]) > 0 &&
      cross(image[0], image[2], image[3]) > 0)
    return {{{0, 1, 2}, {0, 2, 3}}};
  if (!image.empty()) return EarClipping(polygon, image).run();
  std::vector<std::array<int, 3>> fan;
  for (int i = 1; i + 1 < n; ++i) fan.push_back({0, i, i + 1});
  return fan;
}

}  // namespace trimquad
