#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "trimquad/spline/intersection_curve.h"
#include "trimquad/spline/sheet.h"

namespace trimquad {

/// A vertex of the trimmed model with its place on each sheet that meets there.
struct CornerPoint {
  Eigen::Vector3d point;
  std::vector<Eigen::Vector2d> at;  ///< by sheet
};

/// Where the sheets around a corner `p` of the model meet: the foot point of one sheet, the nearest point of
/// the intersection curve of two, the common point of three (Newton). More than three have none, nor have
/// sheets that are nearly tangent: then that of the three which cross most steeply, else of the two, and its
/// foot points on the others. Where these do not meet within `reach` either, the mean of the foot points of
/// `p`, and its own foot points.
/// \param guess         parameters near p, by sheet
/// \param smallestAngle sine of the angle between two sheets below which they are nearly tangent
CornerPoint cornerPoint(const Eigen::Vector3d& p, const std::vector<const Sheet*>& sheets,
                        const std::vector<Eigen::Vector2d>& guess, double reach,
                        double smallestAngle = kSmallestCrossing);

/// A straight line on a sheet, in quads along it from `start`.
struct SheetLine {
  const Sheet* sheet;
  Eigen::Vector2d start, along;  ///< along: a unit vector
  Eigen::Vector2d at(double s) const { return start + s * along; }
};

/// Where along a line, near `guess`, it meets the other sheet, or comes closest to `p` where there is none or
/// they do not meet within `reach` of p.
double placeOnLine(const Eigen::Vector3d& p, const SheetLine& line, double guess, const Sheet* other,
                   const Eigen::Vector2d& otherGuess, double reach);

}  // namespace trimquad
