#pragma once

#include <Eigen/Core>
#include <functional>
#include <utility>
#include <vector>

#include "trimquad/base/progress.h"
#include "trimquad/spline/spline_space.h"

namespace trimquad {

/// Data of a least-squares problem that may slide: of the distance along the directions in which one is free
/// only the part kSlidingCounts counts. This couples the coordinates of the unknowns, so the problem is
/// solved by conjugate gradients from the one in which all of the distances count, whose factor is the
/// preconditioner: the condition number is at most 1 / kSlidingCounts.
class SlidingData {
 public:
  /// Ignores a datum that is not free.
  /// \param terms unknowns and the values of their functions at the datum's parameter
  /// \param point relative to the origin of the unknowns' coordinates
  void add(const Datum& datum, const Eigen::Vector3d& point,
           const std::vector<std::pair<int, double>>& terms);

  /// \param x     the minimum where all of the distances count, unknowns by 3
  /// \param solve by that problem's matrix, of any right-hand side
  Eigen::MatrixXd minimum(Eigen::MatrixXd x,
                          const std::function<Eigen::MatrixXd(const Eigen::MatrixXd&)>& solve,
                          const Progress& progress) const;

 private:
  struct Row {
    std::size_t end;  ///< of its terms in terms_, which begin where those of the row before end
    Eigen::Vector3d point;
    Eigen::Matrix3d lost;  ///< what the quadratic loses
  };
  /// Sum of the rows' functions times what they lose of x less the points, or of x alone.
  Eigen::MatrixXd lost(const Eigen::MatrixXd& x, bool lessPoints) const;

  std::vector<Row> rows_;
  std::vector<std::pair<int, double>> terms_;
};

}  // namespace trimquad
