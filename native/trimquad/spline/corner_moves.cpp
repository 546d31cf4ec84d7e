#include "trimquad/spline/corner_moves.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>

#include "trimquad/spline/corner_point.h"

namespace trimquad {
namespace {

/// Volume of the parallelepiped of three unit normals below which their sheets are led to one point.
constexpr double kFlat = 0.1;
/// Poles that a sheet may come to have, by those it has; and how many more in any case.
constexpr int kMorePoles = 2, kFewPoles = 200;
constexpr double kFade = 1;  ///< quads over which a sheet goes back to where it was
/// Distance of the places beside a corner that give the sheet its tangent plane, quads.
constexpr double kBeside = 1.0 / 64;

/// Whether the sheets around a corner have no common point unless they are made to.
bool needsMoves(const SheetCorner& corner, const std::vector<Sheet>& sheets) {
  std::set<int> distinct;
  std::vector<Eigen::Vector3d> normals;
  for (const auto& use : corner.uses)
    if (distinct.insert(use.sheet).second)
      normals.push_back(normal(sheets[use.sheet].jet(sheets[use.sheet].footPoint(corner.point, use.at))));
  if (normals.size() != 3) return normals.size() > 3;
  return std::abs(normals[0].cross(normals[1]).dot(normals[2])) < kFlat;
}

/// Where the sheets around a corner are to meet.
Eigen::Vector3d meetingPoint(const SheetCorner& corner, const std::vector<Sheet>& sheets,
                             const std::vector<char>& mayMove) {
  std::vector<const Sheet*> still;
  std::vector<Eigen::Vector2d> guess;
  for (const auto& use : corner.uses)
    if (!mayMove[use.sheet]) still.push_back(&sheets[use.sheet]), guess.push_back(use.at);
  return still.empty() ? corner.point : cornerPoint(corner.point, still, guess, HUGE_VAL).point;
}

void appendMoves(const Sheet& sheet, const SheetCorner::Use& use, const Eigen::Vector3d& target, double error,
                 bool withTangents, std::vector<SurfaceMove>& moves) {
  const Eigen::Vector2d y = sheet.footPoint(target, use.at);
  const auto jet = sheet.jet(y);
  const Eigen::Vector3d by = target - jet.s;
  moves.push_back({y, by, {1, 1}, 1, error});
  if (!withTangents || !use.normal) return;
  for (const Eigen::Vector2d& step : {Eigen::Vector2d(kBeside, 0), Eigen::Vector2d(0, kBeside)})
    for (const double sign : {-1.0, 1.0}) {
      const Eigen::Vector2d aside = sign * step;
      const double off = (jet.su * aside[0] + jet.sv * aside[1]).dot(*use.normal);
      if (sheet.holds(y + aside)) moves.push_back({y + aside, by - off * *use.normal, {1, 1}, 1, HUGE_VAL});
    }
}

}  // namespace

std::vector<int> meetInCorners(std::vector<Sheet>& sheets, const std::vector<SheetCorner>& corners,
                               const std::vector<char>& mayMove, double error, const SheetMover& mover) {
  struct Meeting {
    const SheetCorner::Use* use;
    Eigen::Vector3d point;
  };
  std::vector<std::vector<Meeting>> meetings(sheets.size());
  for (const auto& corner : corners) {
    if (!needsMoves(corner, sheets)) continue;
    const Eigen::Vector3d point = meetingPoint(corner, sheets, mayMove);
    for (const auto& use : corner.uses)
      if (mayMove[use.sheet]) meetings[use.sheet].push_back({&use, point});
  }
  std::vector<int> moved;
  for (int k = 0; k < int(sheets.size()); ++k) {
    if (meetings[k].empty()) continue;
    const int poles = int(sheets[k].surface.poles.size());
    for (const bool withTangents : {true, false}) {
      std::vector<SurfaceMove> moves;
      for (const auto& meeting : meetings[k])
        appendMoves(sheets[k], *meeting.use, meeting.point, error, withTangents, moves);
      if (!mover.move(sheets, k, moves, kFade, kMorePoles * poles + kFewPoles)) continue;
      moved.push_back(k);
      break;
    }
  }
  return moved;
}

}  // namespace trimquad
