#pragma once

#include <array>
#include <optional>
#include <vector>

#include "trimquad/spline/hermite_chain.h"
#include "trimquad/spline/sheet.h"

namespace trimquad {

/// Sine of the angle between sheets below which their intersection says little about where they should meet.
inline constexpr double kSmallestCrossing = 0.05;

/// Sine of the angle between the tangent planes.
double crossingAngle(const SplineSurface::Jet& a, const SplineSurface::Jet& b);

/// A stretch of a curve on which two sheets touch without an edge worth the name: where an edge between them
/// changes from a ridge to a valley, or ends in a corner in which both are tangent.
struct TangentStretch {
  double first, last;  ///< by the curve's parameter
  double blend;        ///< length over which it becomes an edge on both sides
};

/// The curve in which two sheets cut each other near a reference curve R(s): the point at s is the one in the
/// plane through R(s) across R'(s). On tangent stretches it is the place on the first sheet nearest to R(s),
/// and its foot on the second one.
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
  /// \param tangent  where that does not count; with their blends apart from each other
  IntersectionCurve(const Sheet& a, const Sheet& b, SpaceCurve reference, std::vector<Guess> guesses,
                    double reach, double smallestAngle, const std::vector<TangentStretch>& tangent = {});

  /// Refers to copies of both sheets instead.
  void setSheets(const Sheet& a, const Sheet& b) { a_ = &a, b_ = &b; }
  const Sheet& a() const { return *a_; }
  const Sheet& b() const { return *b_; }
  const SpaceCurve& reference() const { return reference_; }

  /// Null where the sheets are nearly tangent, or do not meet within reach (Newton).
  std::optional<Parameters> parameters(double s) const;

  /// How far the sheets' places of parameter `s` are from each other: 0 where they cut each other.
  double apart(double s) const;
  /// Where tangent stretches and their blends begin and end.
  const std::vector<double>& tangentEnds() const { return tangentEnds_; }

  /// (uA, vA, uB, vB, x, y, z) with derivatives with respect to s, by implicit differentiation.
  /// Throws Missing where there is no such point.
  CurveJet<7> jet(double s) const;
  struct Missing {};

  /// The reference's parameter whose cross plane holds `p`, near `guess`; may lie a little outside its range.
  double parameterOf(const Eigen::Vector3d& p, double guess) const;

 private:
  /// The four equations of a point, q * (SA - SB) + p * (SA - R) = 0, with derivatives by s of their
  /// coefficients.
  struct Equations {
    std::array<Eigen::Matrix<double, 4, 3>, 3> q, p;
    Eigen::Vector4d residual(const SplineSurface::Jet& a, const SplineSurface::Jet& b,
                             const Eigen::Vector3d& r) const;
    Eigen::Matrix4d jacobian(const SplineSurface::Jet& a, const SplineSurface::Jet& b) const;
  };
  /// A tangent stretch with what makes the condition across it one of unit size.
  struct Stretch : TangentStretch {
    Eigen::Vector3d normal;
    std::array<double, 2> slope;  ///< of the sheets against each other, across the curve, before and after
  };
  Parameters guessAt(double s) const;
  /// The stretch, or its blend, that holds `s`.
  const Stretch* stretchAt(double s) const;
  Equations equations(double s, const std::vector<Eigen::Vector3d>& r) const;

  const Sheet* a_;
  const Sheet* b_;
  SpaceCurve reference_;
  std::vector<Guess> guesses_;
  double reach_, smallestAngle_;
  std::vector<Stretch> stretches_;
  std::vector<double> tangentEnds_;
};

}  // namespace trimquad
