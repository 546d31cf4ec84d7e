#pragma once

#include <array>
#include <vector>

#include "trimquad/spline/intersection_curve.h"
#include "trimquad/spline/trim_curve.h"

namespace trimquad {

/// Sine of the angle of a fold: the slight edge that sheets which touch are given.
inline constexpr double kFold = 0.01;
/// Sines of the angles between sheets from which on they are not turned: where they make an edge of the kind
/// that they are to make, and of the other one.
inline constexpr double kKept = 0.15, kTurned = 0.3;

/// The edge that two sheets are to make along a curve which they touch along, by sample of the curve.
struct FoldPlan {
  /// Sine of the angle between the sheets: above 0 where they make a ridge, seen from outside, below where
  /// they make a valley; infinite from a right angle on.
  std::vector<double> angle;
  std::vector<double> kind;   ///< 1 where they are to make a ridge, -1 where they are to make a valley
  std::vector<double> level;  ///< sine of the angle that they are to make at least
  std::array<std::vector<char>, 2> given;  ///< by side: whether curves around a corner say how the sheet lies
  std::vector<TangentStretch> tangent;     ///< by chord length; around corners, and where the kind changes
  std::vector<char> near;                  ///< whether the sample lies in a tangent stretch or its blend
};

/// \param sheets      on the left of the curve, seen from outside, and on the right; or the other way around
/// \param firstOnLeft which of these
/// \param fixed       by side and end of the curve: whether other curves that end there fix the sheet's
/// tangent plane
FoldPlan planFold(const SampledCurve& sampled, const std::array<const Sheet*, 2>& sheets, bool firstOnLeft,
                  const std::array<std::array<bool, 2>, 2>& fixed);

/// The curve with more samples in tangent stretches and their blends, at most `step` quads of the sheet
/// apart; their feet are guesses.
SampledCurve denserWhereTangent(const SampledCurve& sampled, const FoldPlan& plan, const Sheet& first,
                                double step);

/// From 0 to 1, without slope at both ends.
double smoothStep(double x);

}  // namespace trimquad
