#include "trimquad/spline/tangent_sheets.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <tuple>

#include "trimquad/base/parallel.h"
#include "trimquad/spline/fold_plan.h"

namespace trimquad {
namespace {

/// Poles that a sheet may come to have, by those it has; and how many more in any case.
constexpr int kMorePolesAlongCurve = 6, kFewPolesAlongCurve = 10000;
/// Weight of the lines beside a curve, which give the sheets the same tangents there, and beyond its ends:
/// where the sheets' curvatures differ, or several meet, they cannot agree exactly.
constexpr double kBesideWeight = 0.01;
constexpr double kCornerWeight = 0.01;  ///< length of curve that a corner stands for, quads
/// Sine of the angle between the sheets from which on they have an edge there, and keep it.
constexpr double kSharp = 0.1;
/// Half of the width of the strip in which a sheet that moves onto its curve gets its slope, quads.
constexpr double kStrip = 1.0 / 32;
/// Weight of places on a curve against slopes there.
constexpr double kPlaceWeight = 1000;
/// What of a fold's angle may be missed; up to which angle sheets are turned back to make it.
constexpr double kFoldMissed = 0.001, kFlattened = 0.02;
/// How much longer than nothing the sum of two curves' unit directions out of a corner is from which on both
/// fix a sheet's tangent plane there.
constexpr double kBends = 0.05;
/// Quads between samples in tangent stretches at most: as close as the knots are, between samples that are
/// farther apart sheets stray from the curve.
constexpr double kTangentStep = 1.0 / 128;
/// Quads over which sheets go back to where they were.
constexpr double kFade = 1, kFadeFromCurve = 0.125;
/// How far the strip goes on beyond the curve's ends, where the model's corners may lie off them: by its
/// width.
constexpr double kBeyondEnds[] = {1, 2, 4};

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

/// How sheets are turned about the curve that they move onto.
enum class Turning {
  ToFold,    ///< until they make the fold, where they are not far from it
  AwayFrom,  ///< where they do not make as much of an edge
  None       ///< they stay parallel to what they were
};

/// What leads a curve's samples to the corners, over this part of its length at both ends.
class LedToCorners {
 public:
  explicit LedToCorners(const TangentCurve& curve)
      : s_(curve.sampled->s),
        start_(curve.ends[0] - curve.sampled->point.front()),
        end_(curve.ends[1] - curve.sampled->point.back()) {}
  Eigen::Vector3d operator()(std::size_t i) const {
    const double part = 1.0 / 8 * (s_.back() - s_.front());
    return (1 - smoothStep((s_[i] - s_.front()) / part)) * start_ +
           (1 - smoothStep((s_.back() - s_[i]) / part)) * end_;
  }

 private:
  const std::vector<double>& s_;
  Eigen::Vector3d start_, end_;
};

/// Moves onto the curve.
/// \param lead added to the curve's samples
void appendMovesToCurve(const StripMoves& strip, const LedToCorners& lead, const FoldPlan& plan, int side,
                        bool onLeft, Turning turning, const JoinLimits& limits, double gap,
                        std::vector<SurfaceMove>& moves) {
  constexpr double share = 0.5;  // of the turning that is this sheet's
  for (std::size_t i = 0; i < strip.samples(); ++i) {
    const double error = plan.near[i] ? std::min(gap / 2, limits.tangentError) : gap / 2;
    if (!strip.append(i, strip.point(i) + lead(i), error, {}, moves)) continue;
    const std::size_t placed = moves.size() - 1;
    if (!plan.given[side][i]) {
      const double angle = plan.kind[i] * plan.angle[i];
      const bool turns = turning != Turning::None && angle < kKept && angle > -kTurned;
      double turn = turns ? plan.level[i] - angle : 0;
      if (turn < 0)
        turn *= turning == Turning::ToFold ? 1 - smoothStep((angle - kFlattened) / (kKept - kFlattened)) : 0;
      strip.setSlope((onLeft ? -share : share) * plan.kind[i] * turn, turns ? kFoldMissed : HUGE_VAL, moves);
    }
    if (plan.near[i]) {
      moves[placed].weight *= kPlaceWeight;
      moves[placed].firm = true;
    }
  }
}

/// What body `moving` has to move by in a corner to meet the sheet of lower rank that has the same tangents
/// there.
/// \param own the sheets before it moves \param rank by sheet
template <class Rank>
void appendCornerMoves(const SheetCorner& corner, int moving, const std::vector<Sheet>& own,
                       const std::vector<Sheet>& sheets, const SheetMover& mover, const Rank& rank,
                       double error, SheetMoves& moves) {
  for (const auto& use : corner.uses) {
    if (mover.bodyOf(use.sheet) != moving) continue;
    const Eigen::Vector2d y = own[use.sheet].footPoint(corner.point, use.at);
    const auto at = own[use.sheet].jet(y);
    const SheetCorner::Use* still = nullptr;
    SplineSurface::Jet there;
    for (const auto& other : corner.uses) {
      if (!(rank(other.sheet) < rank(use.sheet)) || (still && !(rank(other.sheet) < rank(still->sheet))))
        continue;
      const auto jet = sheets[other.sheet].jet(sheets[other.sheet].footPoint(corner.point, other.at));
      if (crossingAngle(jet, at) > kSharp) continue;
      still = &other;
      there = jet;
    }
    if (!still) continue;
    // Across the sheet only: along it the feet differ as little.
    const Eigen::Vector3d n = normal(at);
    moves[use.sheet].push_back({y, n.dot(there.s - at.s) * n, {1, 1}, kCornerWeight, error});
    if (mover.bodies()[moving].isSingle()) return;
  }
}

/// One side of a curve.
struct CurveSide {
  std::size_t curve;
  int side;
};

class SheetJoiner {
 public:
  SheetJoiner(std::vector<Sheet>& sheets, const std::vector<TangentCurve>& curves,
              const std::vector<SheetCorner>& corners, const JoinLimits& limits, int threads,
              const SheetMover& mover)
      : sheets_(sheets),
        fitted_(sheets),
        curves_(curves),
        corners_(corners),
        limits_(limits),
        threads_(threads),
        mover_(mover),
        sides_(mover.bodies().size()),
        states_(mover.bodies().size()) {
    for (std::size_t c = 0; c < curves.size(); ++c)
      for (const int side : {0, 1}) sides_[bodyOf(curves[c].sides[side])].push_back({c, side});
    plans_.resize(curves.size());
    denser_.resize(curves.size());
    std::vector<std::array<std::array<bool, 2>, 2>> fixed;
    for (std::size_t c = 0; c < curves.size(); ++c) fixed.push_back({fixedEnds(c, 0), fixedEnds(c, 1)});
    parallelEach(int(curves.size()), threads, [&](int c) {
      if (!onCurve(c)) return;
      const auto& [a, b] = curves_[c].sides;
      const std::array<const Sheet*, 2> both{&fitted_[a.sheet], &fitted_[b.sheet]};
      const bool onLeft = a.onLeft;
      const auto plan = [&] { plans_[c] = planFold(*curves_[c].sampled, both, onLeft, fixed[c]); };
      plan();
      if (plans_[c].tangent.empty()) return;
      denser_[c] = denserWhereTangent(*curves_[c].sampled, plans_[c], fitted_[a.sheet], kTangentStep);
      curves_[c].sampled = &denser_[c];
      plan();
    });
  }

  JoinedSheets join() {
    std::vector<int> moving;
    for (int k = 0; k < int(states_.size()); ++k)
      if (mover_.bodies()[k].mayMove() && !sides_[k].empty()) moving.push_back(k);
    std::sort(moving.begin(), moving.end(), [&](int a, int b) { return rank(a) < rank(b); });
    // Those that move onto curves alone do not depend on each other.
    std::vector<int> independent;
    for (const int k : moving)
      if (movesOntoCurvesOnly(k)) independent.push_back(k);
    auto states = states_;
    parallelEach(int(independent.size()), threads_,
                 [&](int i) { states[independent[i]] = moved(independent[i]); });
    states_ = std::move(states);
    for (const int k : moving)
      if (!movesOntoCurvesOnly(k)) states_[k] = moved(k);
    // Those that touch sheets which did not reach their curves follow these.
    for (const int k : moving)
      if (std::any_of(sides_[k].begin(), sides_[k].end(),
                      [&](const CurveSide& s) { return onCurve(s.curve) && follows(k, s); }))
        moveAgain(k);
    JoinedSheets result;
    for (int k = 0; k < int(states_.size()); ++k)
      if (states_[k].moved) result.moved.push_back(k);
    for (std::size_t c = 0; c < curves_.size(); ++c) {
      const auto& [a, b] = curves_[c].sides;
      const bool folded = onCurve(c) && states_[bodyOf(a)].turned && states_[bodyOf(b)].turned;
      result.folded.push_back(folded);
      result.tangent.push_back(folded ? plans_[c].tangent : std::vector<TangentStretch>());
    }
    return result;
  }

 private:
  /// What became of a body.
  struct State {
    bool moved = false, turned = false;
    bool stuck = false;  ///< it is not on its curves
  };

  int bodyOf(const TangentCurve::Side& side) const { return mover_.bodyOf(side.sheet); }

  bool onCurve(std::size_t c) const {
    const auto& [a, b] = curves_[c].sides;
    const SheetBody &first = mover_.ofSheet(a.sheet), &second = mover_.ofSheet(b.sheet);
    return curves_[c].smooth && first.mayMove() && second.mayMove();
  }
  /// Those of lower rank stay where those of higher rank move onto them.
  std::tuple<bool, bool, int> rank(int body) const {
    const SheetBody& b = mover_.bodies()[body];
    return {b.mayMove(), b.isSingle(), body};
  }
  const TangentCurve::Side& otherSide(const CurveSide& s) const { return curves_[s.curve].sides[1 - s.side]; }
  /// Whether body `k` moves onto the other one rather than onto the curve.
  bool follows(int k, const CurveSide& s) const {
    const int still = bodyOf(otherSide(s));
    if (!onCurve(s.curve)) return rank(still) < rank(k);
    return states_[still].stuck && (!states_[k].stuck || still < k);
  }

  /// Direction out of the corner at the end of a curve.
  Eigen::Vector3d wayOut(std::size_t c, int end) const {
    const auto& p = curves_[c].sampled->point;
    return (end == 0 ? p[1] - p[0] : p[p.size() - 2] - p.back()).normalized();
  }
  /// By end of a curve: whether another one that ends there fixes the tangent plane of the sheet on this
  /// side.
  std::array<bool, 2> fixedEnds(std::size_t c, int side) const {
    std::array<bool, 2> fixed{};
    for (const int end : {0, 1})
      for (const auto& other : sides_[bodyOf(curves_[c].sides[side])])
        for (const int otherEnd : {0, 1}) {
          if (other.curve == c && otherEnd == end) continue;
          if (curves_[other.curve].corners[otherEnd] != curves_[c].corners[end]) continue;
          fixed[end] |=
              curves_[c].tangent[end] && (wayOut(c, end) + wayOut(other.curve, otherEnd)).norm() > kBends;
        }
    return fixed;
  }

  /// Whether where body `k` moves depends on no other one.
  bool movesOntoCurvesOnly(int k) const {
    return std::all_of(sides_[k].begin(), sides_[k].end(),
                       [&](const CurveSide& s) { return onCurve(s.curve); }) &&
           std::all_of(corners_.begin(), corners_.end(),
                       [&](const SheetCorner& c) { return !holds(c, k) || endsACurveOf(k, c); });
  }
  bool holds(const SheetCorner& corner, int k) const {
    return std::any_of(corner.uses.begin(), corner.uses.end(),
                       [&](const SheetCorner::Use& use) { return mover_.bodyOf(use.sheet) == k; });
  }
  bool endsACurveOf(int k, const SheetCorner& corner) const {
    return std::any_of(sides_[k].begin(), sides_[k].end(), [&](const CurveSide& s) {
      const auto& ends = curves_[s.curve].corners;
      return onCurve(s.curve) && (ends[0] == corner.id || ends[1] == corner.id);
    });
  }

  SheetMoves movesOf(int k, Turning turning) const {
    SheetMoves moves;
    for (const auto& s : sides_[k]) {
      const auto& curve = curves_[s.curve];
      const int sheet = curve.sides[s.side].sheet;
      const StripMoves strip(*curve.sampled, s.side, fitted_[sheet]);
      if (follows(k, s)) {
        appendMovesOnto(strip, sheets_[otherSide(s).sheet], curve.sampled->foot[1 - s.side], limits_.width,
                        curve.gap, moves[sheet]);
      } else if (movesToCurve(k, s)) {
        appendMovesToCurve(strip, LedToCorners(curve), plans_[s.curve], s.side, curve.sides[s.side].onLeft,
                           turning, limits_, curve.gap, moves[sheet]);
      }
    }
    for (const auto& corner : corners_)
      if (!endsACurveOf(k, corner))
        appendCornerMoves(
            corner, k, fitted_, sheets_, mover_, [&](int sheet) { return rank(mover_.bodyOf(sheet)); },
            limits_.gap, moves);
    std::erase_if(moves, [](const auto& ofSheet) { return ofSheet.second.empty(); });
    return moves;
  }
  bool movesToCurve(int k, const CurveSide& s) const {
    return onCurve(s.curve) && !states_[bodyOf(otherSide(s))].stuck && !states_[k].stuck;
  }

  /// Moves body `k`.
  State moved(int k) {
    const bool toCurve = std::any_of(sides_[k].begin(), sides_[k].end(),
                                     [&](const CurveSide& s) { return movesToCurve(k, s); });
    for (const bool lastResort : {false, true})
      for (const auto turning : {Turning::ToFold, Turning::AwayFrom, Turning::None}) {
        if (turning != Turning::ToFold && !toCurve) continue;
        const SheetMoves moves = movesOf(k, turning);
        if (moves.empty()) return {};
        const int most = kMorePolesAlongCurve * mover_.poles(fitted_, k, moves) + kFewPolesAlongCurve;
        if (!mover_.move(sheets_, k, moves, toCurve ? kFadeFromCurve : kFade, most, lastResort)) continue;
        return {true, toCurve && turning != Turning::None, false};
      }
    return {false, false, true};
  }
  void moveAgain(int k) {
    const SheetBody& body = mover_.bodies()[k];
    const auto from = sheets_.begin() + body.first, to = from + body.count;
    const std::vector<Sheet> before(from, to);
    std::copy(fitted_.begin() + body.first, fitted_.begin() + body.first + body.count, from);
    if (const State state = moved(k); !state.stuck)
      states_[k] = {state.moved, state.turned, states_[k].stuck};
    else
      std::copy(before.begin(), before.end(), from);
  }

  std::vector<Sheet>& sheets_;
  const std::vector<Sheet> fitted_;
  std::vector<TangentCurve> curves_;
  std::vector<SampledCurve> denser_;  ///< by curve, where it has tangent stretches
  const std::vector<SheetCorner>& corners_;
  const JoinLimits limits_;
  int threads_;
  const SheetMover& mover_;
  std::vector<std::vector<CurveSide>> sides_;  ///< by body
  std::vector<FoldPlan> plans_;                ///< by curve
  std::vector<State> states_;                  ///< by body
};

}  // namespace

JoinedSheets joinTangentSheets(std::vector<Sheet>& sheets, const std::vector<TangentCurve>& curves,
                               const std::vector<SheetCorner>& corners, const JoinLimits& limits, int threads,
                               const SheetMover& mover) {
  return SheetJoiner(sheets, curves, corners, limits, threads, mover).join();
}

}  // namespace trimquad
