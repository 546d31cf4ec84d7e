#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace trimquad {

/// Closest-point search on a set of triangles by a hierarchy of axis-aligned boxes. Immutable once built, so
/// that several threads may ask it at the same time. Deterministic: the same triangles give the same answers.
class TriangleTree {
 public:
  /// Any finite triangles, degenerate ones too, in any arrangement. O(n log n).
  /// Throws Error(Input) without any triangle.
  TriangleTree(std::vector<Eigen::Vector3d> points, std::vector<std::array<int, 3>> triangles);

  struct Hit {
    int triangle;                 ///< index of the triangle
    Eigen::Vector3d point;        ///< the closest point on it, model units
    Eigen::Vector3d barycentric;  ///< of `point`, by corner; each in [0, 1], sum 1
    double squaredDistance;       ///< from the query to `point`
  };

  /// The closest point of all triangles to `p`.
  Hit closest(const Eigen::Vector3d& p) const;

  /// The closest point on the triangles whose normals make less than a right angle with `facing`; none where
  /// there are none. Tells the two sides of a thin part apart.
  std::optional<Hit> closestFacing(const Eigen::Vector3d& p, const Eigen::Vector3d& facing) const;

  /// The same on those within a distance whose normals make less than half a right angle with the unit vector
  /// `facing`.
  std::optional<Hit> closestFacing(const Eigen::Vector3d& p, const Eigen::Vector3d& facing,
                                   double distance) const;

  const std::vector<Eigen::Vector3d>& points() const { return points_; }
  const std::vector<std::array<int, 3>>& triangles() const { return triangles_; }

 private:
  struct Node {
    Eigen::Vector3d low, high;
    std::int32_t
        first;  ///< leaf: its first place in order_; inner: the second child (the first follows the node)
    std::int32_t count;  ///< leaf: how many triangles; inner: 0
  };

  template <typename Accept>
  std::optional<Hit> search(const Eigen::Vector3d& p, double squaredDistance, const Accept& accept) const;
  void build(int first, int last, const std::vector<Eigen::Vector3d>& centers);

  std::vector<Eigen::Vector3d> points_;
  std::vector<std::array<int, 3>> triangles_;
  std::vector<int> order_;   ///< triangle indices, leaf by leaf
  std::vector<Node> nodes_;  ///< depth first, the root in front
};

/// The point of the triangle a, b, c closest to `p`, as barycentric coordinates. A degenerate triangle counts
/// as its longest side. Source: C. Ericson, Real-Time Collision Detection, section 5.1.5.
Eigen::Vector3d closestOnTriangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                  const Eigen::Vector3d& b, const Eigen::Vector3d& c);

}  // namespace trimquad
