#include "trimquad/spline/tangent_sheets.h"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

namespace trimquad {
namespace {

/// Poles that a sheet may come to have, by those it has; and how many more in any case.
constexpr int kMorePoles = 6, kFewPoles = 2000;
/// Weight of the lines beside a curve, which give the sheets the same tangents there, and beyond its ends:
/// where the sheets' curvatures differ, or several meet, they cannot agree exactly.
constexpr double kBesideWeight = 0.01;
constexpr double kCornerWeight = 0.01;  ///< length of curve that a corner stands for, quads
/// Sine of the angle between the sheets from which on they have an edge there, and keep it.
constexpr double kSharp = 0.1;
/// Half of the width of the strip in which a sheet that moves onto its curve gets its slope, quads.
constexpr double kStrip = 1.0 / 32;
/// Sine of the angle of a fold, and what of it may be missed; of the angles up to which sheets are turned to
/// make it, and from which on they are not turned.
constexpr double kFold = 0.01, kFoldMissed = 0.001, kFlattened = 0.02, kKept = 0.15;
/// Quads over which sheets go back to where they were.
constexpr double kFade = 1, kFadeFromCurve = 0.125;
/// How far the strip goes on beyond the curve's ends, where the model's corners may lie off them: by its
/// width.
constexpr double kBeyondEnds[] = {1, 2, 4};

/// The way in the parameter plane that goes nearest to `way` on the surface.
Eigen::Vector2d inPlane(const SplineSurface::Jet& jet, const Eigen::Vector3d& way) {
  Eigen::Matrix<double, 3, 2> m;
  m << jet.su, jet.sv;
  return m.colPivHouseholderQr().solve(way);
}

bool within(const Sheet& sheet, const Eigen::Vector2d& x) {
  const auto& s = sheet.surface;
  return (sheet.period || (x[0] >= s.firstU() && x[0] <= s.lastU())) && x[1] >= s.firstV() &&
         x[1] <= s.lastV();
}

/// What a sheet has to move by to pass through given places near one sample of a curve.
class StripMoves {
 public:
  StripMoves(const SampledCurve& sampled, int side, const Sheet& moving)
      : sampled_(sampled), side_(side), moving_(moving) {}

  std::size_t samples() const { return sampled_.s.size(); }
  const Eigen::Vector3d& point(std::size_t i) const { return sampled_.point[i]; }
  Eigen::Vector3d direction(std::size_t i) const {
    const auto [before, after] = around(i);
    return (sampled_.point[after] - sampled_.point[before]).normalized();
  }
  SplineSurface::Jet jet(std::size_t i) const {
    return moving_.jet(moving_.footPoint(sampled_.point[i], sampled_.foot[side_][i]));
  }
  /// Whether there is such a move: beyond the sheet's end there is none.
  /// \param error  see SurfaceMove
  /// \param facing a normal that the sheet's has to be nearly parallel to
  bool append(std::size_t i, const Eigen::Vector3d& place, double error,
              const std::optional<Eigen::Vector3d>& facing, std::vector<SurfaceMove>& moves) const {
    const Eigen::Vector2d y = moving_.footPoint(place, sampled_.foot[side_][i]);
    const auto at = moving_.jet(y);
    if (facing && facing->cross(normal(at)).norm() > kSharp) return false;
    const Eigen::Vector3d by = place - at.s;
    const double sliding =
        std::max(std::abs(by.dot(at.su.normalized())), std::abs(by.dot(at.sv.normalized())));
    constexpr double rounding = 1e-9;
    if (sliding > 1e-3 * by.norm() + rounding) return false;
    const Eigen::Vector2d run = inPlane(at, direction(i));
    const auto [before, after] = around(i);
    const double length = run.norm() * (sampled_.s[after] - sampled_.s[before]) / 2;
    moves.push_back({y, by, run, error < HUGE_VAL ? length : kBesideWeight * length, error});
    return true;
  }
  /// Makes the last move one of the places on both sides of it as well, so that the sheet is not turned, or
  /// by as much as said. \param turn   slope, to the left \param missed how much of it may be missed;
  /// HUGE_VAL where it does not count
  void setSlope(double turn, double missed, std::vector<SurfaceMove>& moves) const {
    const SurfaceMove last = moves.back();
    const auto jet = moving_.jet(last.at);
    const Eigen::Vector2d left =
        inPlane(jet, normal(jet).cross(jet.su * last.along[0] + jet.sv * last.along[1]));
    const Eigen::Vector2d step = kStrip * left.normalized();
    const double width = (jet.su * step[0] + jet.sv * step[1]).norm();
    for (const double to : {-1.0, 1.0})
      if (within(moving_, last.at + to * step))
        moves.push_back({last.at + to * step, last.by + to * width * turn * normal(jet),
                         step / kStrip + last.along.normalized(), last.weight, missed * width});
  }

 private:
  std::pair<std::size_t, std::size_t> around(std::size_t i) const {
    return {i == 0 ? 0 : i - 1, std::min(i + 1, sampled_.s.size() - 1)};
  }

  const SampledCurve& sampled_;
  int side_;
  const Sheet& moving_;
};

/// Moves onto another sheet.
void appendMovesOnto(const StripMoves& strip, const Sheet& still, const std::vector<Eigen::Vector2d>& feet,
                     double width, double error, std::vector<SurfaceMove>& moves) {
  const auto append = [&](std::size_t i, double along, double across) {
    Eigen::Vector2d x = still.footPoint(strip.point(i), feet[i]);
    const auto jet = still.jet(x);
    const Eigen::Vector3d t = strip.direction(i), n = normal(jet);
    x += inPlane(jet, along * t + across * n.cross(t));
    if (!within(still, x)) return;
    std::optional<Eigen::Vector3d> facing;
    if (across != 0) facing = n;
    const bool onCurve = along == 0 && across == 0;
    strip.append(i, still.jet(x).s, onCurve ? error : HUGE_VAL, facing, moves);
  };
  for (std::size_t i = 0; i < strip.samples(); ++i)
    for (const int line : {-1, 0, 1}) append(i, 0, line * width);
  for (const double beyond : kBeyondEnds)
    for (const int line : {-1, 0, 1}) {
      append(0, -beyond * width, line * width);
      append(strip.samples() - 1, beyond * width, line * width);
    }
}

/// The sines of the angles between a curve's sheets, by sample: above 0 where they make a ridge, seen from
/// outside, below where they make a valley; infinite from a right angle on.
std::vector<double> angles(const TangentCurve& curve, const std::vector<Sheet>& sheets) {
  std::vector<double> found;
  const StripMoves strips[] = {{*curve.sampled, 0, sheets[curve.sides[0].sheet]},
                               {*curve.sampled, 1, sheets[curve.sides[1].sheet]}};
  for (std::size_t i = 0; i < strips[0].samples(); ++i) {
    const Eigen::Vector3d n[] = {normal(strips[0].jet(i)), normal(strips[1].jet(i))};
    const int left = curve.sides[0].onLeft ? 0 : 1;
    const double sine = n[left].cross(n[1 - left]).dot(strips[0].direction(i));
    found.push_back(n[0].dot(n[1]) > 0 ? sine : std::copysign(HUGE_VAL, sine));
  }
  return found;
}

/// Whether less turning makes a curve's sheets a ridge than a valley.
bool isRidge(const std::vector<double>& angles) {
  double ridge = 0, valley = 0;
  for (const double angle : angles) {
    ridge += std::max(0.0, kFold - angle);
    valley += std::max(0.0, kFold + angle);
  }
  return ridge <= valley;
}

/// From 0 to 1, without slope at both ends.
double smoothStep(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * (3 - 2 * x);
}

/// How sheets are turned about the curve that they move onto.
enum class Turning {
  ToFold,    ///< until they make the fold, where they are not far from it
  AwayFrom,  ///< where they do not make as much of an edge
  None       ///< they stay parallel to what they were
};

/// Moves onto the curve.
/// \param angles between the sheets, by sample \param share  of the turning that is this sheet's
void appendMovesToCurve(const StripMoves& strip, bool onLeft, bool ridge, const std::vector<double>& angles,
                        double share, Turning turning, double gap, std::vector<SurfaceMove>& moves) {
  for (std::size_t i = 0; i < strip.samples(); ++i) {
    if (!strip.append(i, strip.point(i), gap / 2, {}, moves)) continue;
    const double angle = ridge ? angles[i] : -angles[i];
    const bool turns = turning != Turning::None && std::abs(angle) < kKept;
    double turn = turns ? kFold - angle : 0;
    if (turn < 0)
      turn *= turning == Turning::ToFold ? 1 - smoothStep((angle - kFlattened) / (kKept - kFlattened)) : 0;
    strip.setSlope((onLeft == ridge ? -share : share) * turn, turns ? kFoldMissed : HUGE_VAL, moves);
  }
}

/// What sheet `moving` has to move by in a corner to meet the one of lower rank that has the same tangents
/// there.
template <class Rank>
void appendCornerMove(const SheetCorner& corner, int moving, const std::vector<Sheet>& sheets,
                      const Rank& rank, double error, std::vector<SurfaceMove>& moves) {
  const auto own = std::find_if(corner.uses.begin(), corner.uses.end(),
                                [&](const SheetCorner::Use& use) { return use.sheet == moving; });
  if (own == corner.uses.end()) return;
  const Eigen::Vector2d y = sheets[moving].footPoint(corner.point, own->at);
  const auto at = sheets[moving].jet(y);
  const SheetCorner::Use* still = nullptr;
  SplineSurface::Jet there;
  for (const auto& use : corner.uses) {
    if (!(rank(use.sheet) < rank(moving)) || (still && !(rank(use.sheet) < rank(still->sheet)))) continue;
    const auto jet = sheets[use.sheet].jet(sheets[use.sheet].footPoint(corner.point, use.at));
    if (normal(jet).cross(normal(at)).norm() > kSharp) continue;
    still = &use;
    there = jet;
  }
  if (!still) return;
  // Across the sheet only: along it the feet differ as little.
  const Eigen::Vector3d n = normal(at);
  moves.push_back({y, n.dot(there.s - at.s) * n, {1, 1}, kCornerWeight, error});
}

}  // namespace

JoinedSheets joinTangentSheets(std::vector<Sheet>& sheets, const std::vector<TangentCurve>& curves,
                               const std::vector<SheetCorner>& corners, const std::vector<char>& mayMove,
                               const JoinLimits& limits, const SheetMover& mover) {
  const auto rank = [&](int sheet) { return std::pair(bool(mayMove[sheet]), sheet); };
  std::vector<char> onCurve, ridge;  // by curve
  for (const auto& curve : curves) {
    onCurve.push_back(curve.smooth && mayMove[curve.sides[0].sheet] && mayMove[curve.sides[1].sheet]);
    ridge.push_back(onCurve.back() && isRidge(angles(curve, sheets)));
  }
  std::vector<char> stuck(sheets.size()), turned(sheets.size());  // not on their curves; on them, and turned
  std::set<int> moved;
  /// \param onlyToStuck whether it has only to follow sheets that are stuck
  const auto move = [&](int k, bool onlyToStuck) {
    using enum Turning;
    bool toCurve = false;  // the same for every turning
    for (const auto& [turning, lastResort] : {std::pair(ToFold, false),
                                              {AwayFrom, false},
                                              {None, false},
                                              {ToFold, true},
                                              {AwayFrom, true},
                                              {None, true}}) {
      if (turning != ToFold && !toCurve) continue;
      std::vector<SurfaceMove> moves;
      bool touches = false, toStuck = false;
      toCurve = false;
      for (std::size_t c = 0; c < curves.size(); ++c)
        for (const int side : {0, 1}) {
          const auto& own = curves[c].sides[side];
          if (own.sheet != k) continue;
          touches = true;
          const int still = curves[c].sides[1 - side].sheet;
          const StripMoves strip(*curves[c].sampled, side, sheets[k]);
          if (onCurve[c] && !stuck[still] && !stuck[k]) {
            appendMovesToCurve(strip, own.onLeft, ridge[c], angles(curves[c], sheets),
                               turned[still] ? 1 : 0.5, turning, curves[c].gap, moves);
            toCurve = true;
          } else if (onCurve[c] ? stuck[still] && (!stuck[k] || still < k) : rank(still) < rank(k)) {
            appendMovesOnto(strip, sheets[still], curves[c].sampled->foot[1 - side], limits.width,
                            curves[c].gap, moves);
            toStuck |= onCurve[c];
          }
        }
      if (!touches || (onlyToStuck && !toStuck)) return;
      for (const auto& corner : corners) appendCornerMove(corner, k, sheets, rank, limits.gap, moves);
      if (moves.empty()) return;
      const int most = kMorePoles * int(sheets[k].surface.poles.size()) + kFewPoles;
      if (mover.move(sheets, k, moves, toCurve ? kFadeFromCurve : kFade, most, lastResort)) {
        moved.insert(k);
        turned[k] = toCurve && turning != None;
        return;
      }
      if (turning == None && lastResort && !onlyToStuck) stuck[k] = true;
    }
  };
  const auto folds = [&](std::size_t c) {
    return onCurve[c] && turned[curves[c].sides[0].sheet] && turned[curves[c].sides[1].sheet];
  };
  for (const bool onlyToStuck : {false, true})
    for (int k = 0; k < int(sheets.size()); ++k)
      if (mayMove[k]) move(k, onlyToStuck);
  JoinedSheets result{{moved.begin(), moved.end()}, {}};
  for (std::size_t c = 0; c < curves.size(); ++c) result.folded.push_back(folds(c));
  return result;
}

}  // namespace trimquad
