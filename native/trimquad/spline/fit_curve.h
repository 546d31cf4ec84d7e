#pragma once

#include <functional>
#include <vector>

#include "trimquad/base/progress.h"
#include "trimquad/spline/spline_geometry.h"

namespace trimquad {

/// A point that a curve is to pass near.
template <int Dim>
struct CurveSample {
  double s;  ///< parameter on the fitted curve
  double t;  ///< parameter on the curve that is sampled
  Eigen::Matrix<double, Dim, 1> point;
  /// What a displacement of the point means in space (model units): the identity, or [Su Sv] for a point of
  /// a surface's parameter plane.
  Eigen::Matrix<double, 3, Dim> metric;
};

/// Whether the samples keep their parameters or may slide along the curve.
enum class SampleParameters { Sliding, Fixed };

/// Makes a new sample between two neighbours.
template <int Dim>
using SampleBetween = std::function<CurveSample<Dim>(const CurveSample<Dim>&, const CurveSample<Dim>&)>;

/// The smooth (C^(degree-1)) curve over [first s, last s] with about the fewest knots that stays within
/// `tolerance`, in space, of all samples and of new ones between them: least squares, spans split where the
/// distance is too large. Starts and ends exactly in the first and last sample. The distance of a sliding
/// sample is that from its foot, as far as it gets there without passing another one.
/// \param samples  ascending in s; refined in place where they are far apart for a span
/// Throws Error(Stage, "fit") where no refinement brings the curve within the tolerance.
template <int Dim>
SplineCurve<Dim> fitCurve(std::vector<CurveSample<Dim>>& samples, int degree, double tolerance,
                          SampleParameters parameters, const SampleBetween<Dim>& between,
                          const Progress& progress);

}  // namespace trimquad
