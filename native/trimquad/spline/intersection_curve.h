#pragma once

#include <optional>
#include <vector>

#include "trimquad/spline/hermite_chain.h"
#include "trimquad/spline/sheet.h"

namespace trimquad {

/// Sine of the angle between sheets below which their intersection says little about where they should meet.
inline constexpr double kSmallestCrossing = 0.05;

/// The curve in which two sheets cut each other near a reference curve R(s): the point at s is the one in the
/// plane through R(s) across R'(s).
class IntersectionCurve {
 public:
  /// Parameters on both sheets (uA, vA, uB, vB).
  using Parameters = Eigen::Vector4d;
  struct Guess {
    double s;
    Parameters at;
  };
  /// The sheets are referred to, not copied.
  /// \param reference at least C3
  /// \param guesses   ascending in s
  /// \param reach     how far the curve may lie from the reference, model units
  /// \param smallestAngle sine of the angle between the sheets below which they have no intersection
  IntersectionCurve(const Sheet& a, const Sheet& b, SpaceCurve reference, std::vector<Guess> guesses,
                    double reach, double smallestAngle);

  /// Refers to copies of both sheets instead.
  void setSheets(const Sheet& a, const Sheet& b) { a_ = &a, b_ = &b; }
  const Sheet& a() const { return *a_; }
  const Sheet& b() const { return *b_; }
  const SpaceCurve& reference() const { return reference_; }

  /// Null where the sheets are nearly tangent, or do not meet within reach (Newton).
  std::optional<Parameters> parameters(double s) const;

  /// (uA, vA, uB, vB, x, y, z) with derivatives with respect to s, by implicit differentiation.
  /// Throws Missing where there is no such point.
  CurveJet<7> jet(double s) const;
  struct Missing {};

  /// The reference's parameter whose cross plane holds `p`, near `guess`; may lie a little outside its range.
  double parameterOf(const Eigen::Vector3d& p, double guess) const;

 private:
  const Sheet* a_;
  const Sheet* b_;
  SpaceCurve reference_;
  std::vector<Guess> guesses_;
  double reach_, smallestAngle_;
};

}  // namespace trimquad
