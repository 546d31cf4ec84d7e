#pragma once

#include <array>
#include <vector>

#include "trimquad/spline/spline_space.h"

namespace trimquad {

/// A point of a knot lattice.
struct LatticePoint {
  std::array<int, 2> index;  ///< along u and v; neighbours in the lattice differ by one
  Eigen::Vector3d barycentric;
  double area;  ///< of the part of the plane that it stands for, quads^2
};

/// Points that divide every knot rectangle of a space evenly, and more closely where it lies beside a much
/// narrower one: a surface may leave its way there, between points that are all in the middle of wide ones.
class KnotLattice {
 public:
  /// \param across points to a side of a knot rectangle
  KnotLattice(const SplineSpace& space, int across);

  /// Those in a triangle of the parameter plane. Triangles that fill the plane without overlap share out the
  /// lattice, up to rounding on their sides.
  std::vector<LatticePoint> in(const std::array<Eigen::Vector2d, 3>& triangle) const;

 private:
  std::vector<double> u_, v_;  ///< ends of the parts, ascending; the points are in the middle
};

/// Into how many parts to divide a segment of the parameter plane for as many samples.
int latticeParts(const SplineSpace& space, const Eigen::Vector2d& a, const Eigen::Vector2d& b, int across);

/// Triangles between samples on neighbouring points of a lattice.
/// \param chartAndIndex by sample, the first of which has the number `first`
std::vector<std::array<int, 3>> latticeCells(const std::vector<std::array<int, 3>>& chartAndIndex, int first);

}  // namespace trimquad
