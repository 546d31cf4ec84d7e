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
constexpr int kMorePolesAtCorner = 2, kFewPolesAtCorner = 200;
constexpr double kFadeFromCorner = 1;  ///< quads over which a sheet goes back to where it was
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

/// The bodies around a corner that move: single ones where there are any and no more than one other.
std::set<int> movingBodies(const SheetCorner& corner, const SheetMover& mover) {
  std::set<int> single, joined;
  bool fixed = false;
  for (const auto& use : corner.uses) {
    const SheetBody& body = mover.ofSheet(use.sheet);
    fixed |= !body.mayMove();
    if (body.mayMove()) (body.isSingle() ? single : joined).insert(mover.bodyOf(use.sheet));
  }
  if (joined.size() + fixed > 1 || (single.empty() && joined.size() == 1)) single.merge(joined);
  return single;
}

/// Where the sheets around a corner are to meet.
Eigen::Vector3d meetingPoint(const SheetCorner& corner, const std::vector<Sheet>& sheets,
                             const std::set<int>& moving, const SheetMover& mover) {
  std::vector<const Sheet*> still;
  std::vector<Eigen::Vector2d> guess;
  for (const auto& use : corner.uses) {
    if (moving.count(mover.bodyOf(use.sheet))) continue;
    if (use.endsBorder) return sheets[use.sheet].jet(use.at).s;
    still.push_back(&sheets[use.sheet]), guess.push_back(use.at);
  }
  return still.empty() ? corner.point : cornerPoint(corner.point, still, guess, HUGE_VAL).point;
}

void appendMoves(const Sheet& sheet, const SheetCorner::Use& use, const Eigen::Vector3d& target, double error,
                 bool withTangents, std::vector<SurfaceMove>& moves) {
  const Eigen::Vector2d y = use.placeFor(target, sheet);
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
                               double error, const SheetMover& mover) {
  struct Meeting {
    const SheetCorner::Use* use;
    Eigen::Vector3d point;
  };
  std::vector<std::vector<Meeting>> meetings(mover.bodies().size());
  for (const auto& corner : corners) {
    if (!needsMoves(corner, sheets)) continue;
    const auto moving = movingBodies(corner, mover);
    const Eigen::Vector3d point = meetingPoint(corner, sheets, moving, mover);
    for (const auto& use : corner.uses)
      if (const int body = mover.bodyOf(use.sheet); moving.count(body))
        meetings[body].push_back({&use, point});
  }
  std::vector<int> moved;
  for (int body = 0; body < int(meetings.size()); ++body) {
    if (meetings[body].empty()) continue;
    for (const bool withTangents : {true, false}) {
      SheetMoves moves;
      for (const auto& meeting : meetings[body])
        appendMoves(sheets[meeting.use->sheet], *meeting.use, meeting.point, error, withTangents,
                    moves[meeting.use->sheet]);
      const int poles = mover.poles(sheets, body, moves);
      if (!mover.move(sheets, body, moves, kFadeFromCorner, kMorePolesAtCorner * poles + kFewPolesAtCorner))
        continue;
      moved.push_back(body);
      break;
    }
  }
  return moved;
}

}  // namespace trimquad
