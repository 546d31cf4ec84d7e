#pragma once

#include <map>
#include <optional>
#include <vector>

#include "trimquad/base/sparse_solver.h"
#include "trimquad/spline/layout.h"
#include "trimquad/spline/spline_space.h"

namespace trimquad {

/// What splines over the charts of a layout are made of, apart from the layout.
struct JoinedKnots {
  std::vector<SplineSpace> charts;  ///< by chart of the layout
  /// Weight of the conditions next to a singularity, per quad of border, relative to squared distances per
  /// quad^2 of surface.
  double tangentWeight = 30;
  /// Of exact conditions in the quadratic, relative to the data: much more would drown the fairness in
  /// rounding.
  double exactWeight = 1e6;
  /// By chart and corner in a singularity, as JoinedSpace::singularCorners(): how far from it narrow knot
  /// rectangles count in full towards fairness, quads.
  std::vector<std::vector<double>> stiffReach;
  /// Coefficients of a border at its end in a singularity: of the derivatives into the charts to its left and
  /// right, and of the one along it, all seen away from the singularity.
  struct Gluing {
    double left = 1, right = 1, along = 0;
  };
  /// By border and whether at its start; the others are even.
  std::map<std::pair<int, bool>, Gluing> gluing;
};

/// Splines over all charts of a layout, one tensor-product space each, that agree along the borders.
class JoinedSpace : public JoinedKnots {
 public:
  /// How far borders go on beyond the surface's boundary, for trims that leave the region, quads; to the next
  /// knot from there.
  static constexpr double kBeyondBoundary = 0.5;

  explicit JoinedSpace(const Layout& layout);

  /// Takes the directions in which borders leave singularities from the data: by least squares over those
  /// that lie close to a singularity. Without, and where there are too few, they are evenly spread. \param
  /// data by chart
  void alignTangents(const std::vector<std::vector<Datum>>& data);

  /// By chart of the layout: its corners in singularities.
  std::vector<std::vector<Eigen::Vector2d>> singularCorners() const;

  /// The spline surfaces that minimise the sum over all charts of what SplineSpace::leastSquares minimises,
  /// subject to: both sides of a border have the same curve, whatever their knots; they have the same
  /// derivatives across it (in the common chart) away from singularities and off feature lines. Next to a
  /// singularity, within about two quads, the derivatives of both sides across the border and the one along
  /// it become linearly dependent, with coefficients from the tangents: exactly in the singularity and by
  /// weighted least squares beyond. The conditions hold up to rounding (multipliers).
  ///
  /// Beyond the surface's boundary borders go on by kBeyondBoundary.
  /// \param data by chart. Empty where data and fairness do not determine the surfaces.
  std::optional<std::vector<SplineSurface>> leastSquares(const std::vector<std::vector<Datum>>& data,
                                                         const Fairness& fairness,
                                                         const Progress& progress) const;
  /// The same minimisation over the poles of some charts only: the others stay as they are in `surfaces`, bit
  /// by bit, and the chosen ones go on to fit to them.
  /// \param chosen charts, ascending
  /// \param surfaces by chart, over these knots; they meet the conditions
  std::optional<std::vector<SplineSurface>> leastSquares(const std::vector<std::vector<Datum>>& data,
                                                         const Fairness& fairness,
                                                         const std::vector<int>& chosen,
                                                         std::vector<SplineSurface> surfaces,
                                                         const Progress& progress) const;

 private:
  struct Condition {
    std::vector<std::pair<int, double>> terms;  ///< unknown, factor
    double weight;
    bool exact;
  };
  static Eigen::MatrixXd satisfying(const std::vector<Condition>& conditions, const SparseSolver& solver,
                                    Eigen::MatrixXd x, double rounding, const Progress& progress);
  Gluing gluingOf(int border, bool atStart) const;
  std::vector<int> offsets() const;
  std::vector<Condition> conditions() const;
  void addBorder(int index, const std::vector<int>& offset, std::vector<Condition>& conditions) const;

  const Layout& layout_;
};

}  // namespace trimquad
