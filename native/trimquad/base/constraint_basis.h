#pragma once

#include <Eigen/Sparse>
#include <cstdint>
#include <map>
#include <vector>

namespace trimquad {

/// The solutions of a system of sparse linear equations with integer coefficients, x = (N z + c) / d row by
/// row, with integer N and d. One basis serves every solve on a map: the Poisson solve, untangling and
/// optimisation work on z in doubles; the exact map evaluates it on whole numbers. (pipeline.md, "Numbers")
class ConstraintBasis {
 public:
  using Index = int;
  struct Term {
    Index variable;
    std::int64_t factor;
  };

  explicit ConstraintBasis(Index variables);

  /// sum(factor * x) = constant, where `constant` counts whole quads. An equation that follows from earlier
  /// ones is dropped. Returns false, and changes nothing, where it contradicts them.
  bool addEquation(const std::vector<Term>& terms, std::int64_t constant);

  /// Ends the input of equations. Free variables keep their order: z[i] is x[freeVariable(i)].
  void finish();

  Index variableCount() const { return Index(rows_.size()); }
  Index freeCount() const { return Index(free_.size()); }
  Index freeVariable(Index i) const { return free_[i]; }

  /// x as an affine function of z, for solves in doubles: x = matrix() * z + offset().
  const Eigen::SparseMatrix<double, Eigen::RowMajor>& matrix() const { return matrix_; }
  const Eigen::VectorXd& offset() const { return offset_; }

  /// The values of z that x has. Where x satisfies the equations, evaluating them gives x back.
  Eigen::VectorXd restrict(const Eigen::VectorXd& x) const;

  /// z rounded to whole quanta such that every x is a whole number of quanta, then all x, exactly: the
  /// equations hold to the last bit. \param bits one quad is 2^bits quanta.
  std::vector<std::int64_t> evaluateExact(const Eigen::VectorXd& z, int bits) const;

 private:
  struct Row {  // divisor * x = sum(factor * other) + constant
    std::int64_t divisor = 1, constant = 0;
    std::map<Index, std::int64_t> terms;
    bool dependent = false;
  };
  bool isReduced(const Row& row) const;
  void reduce(Index variable);
  void substitute(std::map<Index, std::int64_t>& terms, std::int64_t& constant, std::int64_t& divisor) const;

  std::vector<Row> rows_;
  std::vector<Index> free_;
  Eigen::SparseMatrix<double, Eigen::RowMajor> matrix_;
  Eigen::VectorXd offset_;
};

}  // namespace trimquad
