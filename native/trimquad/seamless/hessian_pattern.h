#pragma once

#include <Eigen/Sparse>
#include <array>
#include <vector>

#include "trimquad/base/constraint_basis.h"

namespace trimquad {

/// Where the second derivatives of a sum over triangles go in the sparse Hessian by the free unknowns of a
/// basis. Settled once for all Newton steps.
class HessianPattern {
 public:
  using Corners = std::array<int, 6>;  ///< the variables of the basis that a triangle depends on

  HessianPattern() = default;  ///< of no triangles and no unknowns
  HessianPattern(const ConstraintBasis& basis, const std::vector<Corners>& triangles);

  /// The Hessian of nothing: symmetric, with a stored zero wherever a triangle can put something.
  const Eigen::SparseMatrix<double>& zero() const { return zero_; }

  /// Adds the Hessian of one triangle, by its variables. \param hessian  a copy of zero()
  void add(int triangle, const Eigen::Matrix<double, 6, 6>& second,
           Eigen::SparseMatrix<double>& hessian) const;

 private:
  struct Coefficient {  // variable `corner` of a triangle is a sum of value * unknown, over these
    int corner;
    int unknown;  // among those of the triangle
    double value;
  };
  struct Triangle {
    int firstUnknown = 0, firstCoefficient = 0;
    size_t firstPlace = 0;
    int unknowns = 0;
    bool plain = false;  // six variables, each of them an unknown of its own
  };

  Eigen::SparseMatrix<double> zero_;
  std::vector<Triangle> triangles_;  // and the end
  std::vector<Coefficient> coefficients_;
  std::vector<int> place_;  // of (row, column) among the numbers of the Hessian; columns one after another
};

}  // namespace trimquad
