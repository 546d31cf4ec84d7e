#pragma once

#include <Eigen/Core>
#include <vector>

#include "trimquad/base/sparse_solver.h"
#include "trimquad/field/transport.h"

namespace trimquad {

/// The quadratic energy of a field given by one real angle per face, sum of w (a_g - a_f - difference)^2 over
/// the interior edges, and its least solutions. Differences are by edge index: what a_g - a_f should be, from
/// the face f of the edge's halfedge 0 to the face g of its opposite.
class AngleSolve {
 public:
  explicit AngleSolve(const SurfaceMesh& mesh);

  /// Factorises the energy plus sum of faceWeight a_f^2 (with face 0 held where there is no weight at all).
  void factorize(const std::vector<double>& faceWeight);
  Eigen::VectorXd rightHandSide(const std::vector<double>& difference) const;
  Eigen::VectorXd solve(const Eigen::VectorXd& rhs) const { return solver_.solve(rhs); }

  /// sqrt(w) (a_g - a_f - difference) per edge.
  Eigen::VectorXd residual(const Eigen::VectorXd& angle, const std::vector<double>& difference) const;

 private:
  const SurfaceMesh& mesh_;
  std::vector<double> weight_;
  SparseSolver solver_{"field"};
};

/// The angles of parallel transport as differences.
std::vector<double> transported(const SurfaceMesh& mesh, const Transport& transport);

}  // namespace trimquad
