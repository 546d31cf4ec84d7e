#pragma once

#include <Eigen/Sparse>
#include <cstdint>
#include <vector>

namespace trimquad {

/// Where the entries of a Cholesky factor lie: columns of nearly equal pattern are one supernode, stored as a
/// dense block. Depends on the pattern of the matrix only.
class SupernodalPattern {
 public:
  SupernodalPattern() = default;
  /// \param matrix  symmetric, compressed; its lower triangle is read
  explicit SupernodalPattern(const Eigen::SparseMatrix<double>& matrix);

  /// A block of columns; its rows are the columns themselves, then `rows - columns` rows below.
  struct Supernode {
    int firstColumn, columns, rows;
    int parent;           ///< the supernode of the first row below; supernodes.size() at a root
    int firstRow;         ///< in `row` and `rowInParent`: its rows below
    int firstEntry;       ///< in `entry`: the matrix entries that fall into the block
    std::int64_t values;  ///< first number of the block; it is stored by columns
    int below() const { return rows - columns; }
  };
  /// A number of the matrix and its place in the block of its supernode.
  struct Entry {
    int source;
    std::int64_t place;
  };

  int size = 0;                       ///< columns of the matrix
  std::vector<int> order;             ///< columns of the matrix by their place in the factor
  std::vector<Supernode> supernodes;  ///< children before parents; each subtree is an interval
  std::vector<int> row;               ///< rows below, as places in the factor
  std::vector<int> rowInParent;       ///< the same as rows of the parent's block
  std::vector<Entry> entry;
  std::int64_t numbers = 0;  ///< in all blocks
  std::int64_t stack = 0;    ///< most numbers in update matrices that wait for their parents
  double multiplications = 0;  ///< of a factorisation
};

/// Cholesky factorisation L L^T = P A P^T by the multifrontal method: a supernode's block collects the matrix
/// entries and its children's update matrices, is factorised as a dense matrix, and leaves an update matrix
/// for its parent. One thread; the result depends on nothing but the matrix. (Duff, Reid 1983; Liu 1992)
class SupernodalCholesky {
 public:
  void analyse(const Eigen::SparseMatrix<double>& matrix);
  /// Whether the matrix, which has the pattern analysed, is positive definite.
  bool factorize(const Eigen::SparseMatrix<double>& matrix);
  /// A^-1 rhs, for one or several right-hand sides.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& rhs) const;

  const SupernodalPattern& pattern() const { return pattern_; }

 private:
  SupernodalPattern pattern_;
  std::vector<double> values_, stack_;
};

}  // namespace trimquad
