#pragma once

#include <optional>
#include <vector>

#include "trimquad/spline/sheet_mover.h"

namespace trimquad {

/// A corner of the model and the sheets around it.
struct SheetCorner {
  struct Use {
    int sheet;
    Eigen::Vector2d at;  ///< foot of the corner, or close to it
    /// Whether a border between charts ends at `at`, so that this is the place which is to come to the
    /// corner.
    bool endsBorder = false;
    /// The unit normal that the region behind the sheet has there, where that is known.
    std::optional<Eigen::Vector3d> normal = {};

    /// The place that is to come to `target`.
    Eigen::Vector2d placeFor(const Eigen::Vector3d& target, const Sheet& ofUse) const {
      return endsBorder ? at : ofUse.footPoint(target, at);
    }
  };
  Eigen::Vector3d point;
  std::vector<Use> uses;
  int id = 0;  ///< the corner's number
};

/// Moves sheets so that all sheets around a corner pass through one point, with the region's tangent plane
/// where it is known: in corners where they have no common point otherwise, as where more than three sheets
/// meet or the edges of three are tangent (a cusp). The point is the model's own, or that of a body of
/// several sheets where there is only one around (its border's end), or of those which cannot move. A sheet
/// fades back to where it was over about a quad. \param error what a corner may be missed by, model units
/// Returns the bodies that have moved, ascending.
std::vector<int> meetInCorners(std::vector<Sheet>& sheets, const std::vector<SheetCorner>& corners,
                               double error, const SheetMover& mover);

}  // namespace trimquad
