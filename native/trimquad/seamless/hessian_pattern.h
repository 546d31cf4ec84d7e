#pragma once

#include <Eigen/Sparse>
#include <array>
#include <vector>

namespace trimquad {

/// Where the second derivatives of a sum over triangles go in the sparse Hessian by the free unknowns of a
/// basis. Settled once for all Newton steps. Variables along seams and aligned curves are long sums of
/// unknowns, many of them the same: second derivatives by such variables are summed over all triangles first,
/// and spread over their unknowns once, at the end.
class HessianPattern {
 public:
  using Corners = std::array<int, 6>;  ///< the variables of the basis that a triangle depends on

  /// By variable: the sum of unknowns that it is.
  using Basis = Eigen::SparseMatrix<double, Eigen::RowMajor>;

  HessianPattern() = default;  ///< of no triangles and no unknowns
  HessianPattern(const Basis& basis, const std::vector<Corners>& triangles);

  const Basis& basis() const { return basis_; }

  /// The Hessian of nothing: symmetric, with a stored zero wherever a triangle can put something.
  const Eigen::SparseMatrix<double>& zero() const { return zero_; }

  /// A Hessian that triangles are being added to.
  struct Sum {
    Eigen::SparseMatrix<double> hessian;
    std::vector<double> byPair;  ///< second derivatives by pairs of variables that are sums
  };
  Sum start() const { return {zero_, std::vector<double>(pairs_.size(), 0.0)}; }

  /// Adds the Hessian of one triangle, by its variables.
  void add(int triangle, const Eigen::Matrix<double, 6, 6>& second, Sum& sum) const;

  /// About how many multiplications adding and finishing take.
  double work() const { return 36.0 * double(triangles_.size()) + double(place_.size()); }

  /// The Hessian by the unknowns, once all triangles are added.
  Eigen::SparseMatrix<double> finish(Sum&& sum) const;

 private:
  struct Pair {  // of variables
    int row, column;
    size_t firstPlace;  // of (unknown of row, unknown of column); columns one after another
  };
  struct Triangle {
    bool plain;    // six variables, each of them an unknown of its own
    size_t first;  // plain: its 36 places in the Hessian, else its 36 pairs
  };
  void findPairs(const std::vector<Corners>& triangles);
  void findPlaces(const std::vector<Corners>& triangles);

  Eigen::SparseMatrix<double> zero_;
  Basis basis_;
  std::vector<Triangle> triangles_;
  std::vector<int> entry_;   // of triangles: places or pairs, columns one after another
  std::vector<Pair> pairs_;  // sorted
  std::vector<int> place_;   // of pairs, among the numbers of the Hessian
};

}  // namespace trimquad
