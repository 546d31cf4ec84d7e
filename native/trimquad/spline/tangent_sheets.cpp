#include "trimquad/spline/tangent_sheets.h"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "trimquad/base/parallel.h"
#include "trimquad/spline/deviation.h"
#include "trimquad/spline/moved_surface.h"
#include "trimquad/spline/surface_samples.h"

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
/// Half of the width of the strip in which a sheet moves parallel to itself, quads.
constexpr double kParallel = 1.0 / 32;
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
  /// \param exact  whether it is a place of the curve itself
  /// \param facing a normal that the sheet's has to be nearly parallel to
  void append(std::size_t i, const Eigen::Vector3d& place, bool exact,
              const std::optional<Eigen::Vector3d>& facing, std::vector<SurfaceMove>& moves) const {
    const Eigen::Vector2d y = moving_.footPoint(place, sampled_.foot[side_][i]);
    const auto at = moving_.jet(y);
    if (facing && facing->cross(normal(at)).norm() > kSharp) return;
    const Eigen::Vector3d by = place - at.s;
    // Beyond the sheet's end there is no foot.
    const double sliding =
        std::max(std::abs(by.dot(at.su.normalized())), std::abs(by.dot(at.sv.normalized())));
    constexpr double rounding = 1e-9;
    if (sliding > 1e-3 * by.norm() + rounding) return;
    const Eigen::Vector2d run = inPlane(at, direction(i));
    const auto [before, after] = around(i);
    const double length = run.norm() * (sampled_.s[after] - sampled_.s[before]) / 2;
    moves.push_back({y, by, run, exact ? length : kBesideWeight * length, exact});
  }
  /// Makes the last move one of the places on both sides of it as well, so that the sheet is not turned.
  void keepSlope(std::vector<SurfaceMove>& moves) const {
    const SurfaceMove last = moves.back();
    const Eigen::Vector2d across = Eigen::Vector2d(-last.along[1], last.along[0]).normalized();
    for (const double by : {-kParallel, kParallel})
      if (within(moving_, last.at + by * across))
        moves.push_back({last.at + by * across, last.by, last.along, last.weight, false});
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
                     double width, std::vector<SurfaceMove>& moves) {
  const auto append = [&](std::size_t i, double along, double across) {
    Eigen::Vector2d x = still.footPoint(strip.point(i), feet[i]);
    const auto jet = still.jet(x);
    const Eigen::Vector3d t = strip.direction(i), n = normal(jet);
    x += inPlane(jet, along * t + across * n.cross(t));
    if (!within(still, x)) return;
    std::optional<Eigen::Vector3d> facing;
    if (across != 0) facing = n;
    strip.append(i, still.jet(x).s, along == 0 && across == 0, facing, moves);
  };
  for (std::size_t i = 0; i < strip.samples(); ++i)
    for (const int line : {-1, 0, 1}) append(i, 0, line * width);
  for (const double beyond : kBeyondEnds)
    for (const int line : {-1, 0, 1}) {
      append(0, -beyond * width, line * width);
      append(strip.samples() - 1, beyond * width, line * width);
    }
}

/// Moves onto the curve, to be tangent to the surface behind the sheet or to stay parallel to what it was.
void appendMovesToCurve(const StripMoves& strip, const TrueSurface& behind, bool withTangents,
                        std::vector<SurfaceMove>& moves) {
  for (std::size_t i = 0; i < strip.samples(); ++i) {
    const std::size_t before = moves.size();
    strip.append(i, strip.point(i), true, {}, moves);
    if (!withTangents) {
      if (moves.size() > before) strip.keepSlope(moves);
      continue;
    }
    const auto jet = strip.jet(i);
    const Eigen::Vector3d n = normal(jet), across = n.cross(strip.direction(i));
    const double width = kParallel / inPlane(jet, across).norm();
    for (const double side : {-width, width}) {
      const auto beside = behind.closestFacing(strip.point(i) + side * across, n);
      strip.append(i, beside.point, false, beside.normal, moves);
    }
  }
}

/// What sheet `moving` has to move by in a corner to meet the one of lower rank that has the same tangents
/// there.
template <class Rank>
void appendCornerMove(const SheetCorner& corner, int moving, const std::vector<Sheet>& sheets,
                      const Rank& rank, std::vector<SurfaceMove>& moves) {
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
  moves.push_back({y, n.dot(there.s - at.s) * n, {1, 1}, kCornerWeight, true});
}

}  // namespace

std::vector<int> joinTangentSheets(std::vector<Sheet>& sheets, const std::vector<TangentCurve>& curves,
                                   const std::vector<SheetCorner>& corners, const std::vector<char>& mayMove,
                                   double width, double gap,
                                   const std::function<bool(int, const SplineSurface&)>& accepts,
                                   const Progress& progress) {
  const auto rank = [&](int sheet) { return std::pair(bool(mayMove[sheet]), sheet); };
  std::vector<char> stuck(sheets.size());  // could not be moved onto their curves
  const auto meetsOnCurve = [&](const TangentCurve& curve) {
    return curve.behind[0] && curve.behind[1] && mayMove[curve.sheet[0]] && mayMove[curve.sheet[1]];
  };
  std::set<int> moved;
  /// \param onlyToStuck whether it has only to follow sheets that are stuck
  const auto move = [&](int k, bool onlyToStuck) {
    // Where a surface bends within the tolerance, the sheet may have another tangent than it; to turn it there
    // would lift it around.
    for (const bool withTangents : {true, false}) {
      progress.check();
      std::vector<SurfaceMove> moves;
      bool touches = false, toCurve = false, toStuck = false;
      for (const auto& curve : curves)
        for (const int side : {0, 1}) {
          if (curve.sheet[side] != k) continue;
          touches = true;
          const int still = curve.sheet[1 - side];
          const StripMoves strip(*curve.sampled, side, sheets[k]);
          const bool onCurve = meetsOnCurve(curve);
          if (onCurve && !stuck[still] && !stuck[k]) {
            appendMovesToCurve(strip, *curve.behind[side], withTangents, moves);
            toCurve = true;
          } else if (onCurve ? stuck[still] && (!stuck[k] || still < k) : rank(still) < rank(k)) {
            appendMovesOnto(strip, sheets[still], curve.sampled->foot[1 - side], width, moves);
            toStuck |= onCurve;
          }
        }
      if (!touches || (onlyToStuck && !toStuck) || (!withTangents && !toCurve)) return;
      for (const auto& corner : corners) appendCornerMove(corner, k, sheets, rank, moves);
      if (moves.empty()) return;
      const int poles = int(sheets[k].surface.poles.size());
      auto surface =
          movedSurface(sheets[k].surface, moves, gap / 2, kMorePoles * poles + kFewPoles, progress);
      if (surface && accepts(k, *surface)) {
        sheets[k].surface = std::move(*surface);
        moved.insert(k);
        return;
      }
      if (!withTangents && !onlyToStuck) stuck[k] = true;
    }
  };
  for (const bool onlyToStuck : {false, true})
    for (int k = 0; k < int(sheets.size()); ++k)
      if (mayMove[k]) move(k, onlyToStuck);
  return {moved.begin(), moved.end()};
}

ChartDeviation deviationFrom(const SplineSurface& surface, const Region& region, const GridMap& map,
                             const FittedSurface& fitted, int threads, const Progress& progress) {
  ChartDeviation result;
  if (map.mesh.n_faces() == 0) return result;
  SplineSpace space{{surface.degreeU, surface.closedU, {}}, {surface.degreeV, false, {}}};
  space.u.breaks.assign(surface.knotsU.begin() + surface.degreeU, surface.knotsU.end() - surface.degreeU);
  space.v.breaks.assign(surface.knotsV.begin() + surface.degreeV, surface.knotsV.end() - surface.degreeV);
  SurfaceSamples source(region, map, fitted.chart, surface.firstU(), progress);
  auto samples = source.make(space, true, threads, progress);
  parallelParts(int(samples.size()), threads, [&](int begin, int end) {
    progress.check();
    for (int i = begin; i < end; ++i) {
      auto& s = samples[i];
      const Eigen::Vector2d foot = surface.footPoint(s.point, s.parameter, kFootStep);
      s.distance = (surface.point(foot[0], foot[1]) - s.point).norm();
    }
  });
  const Deviation deviation = deviationOf(samples, std::vector<char>(samples.size(), 0));
  result.max = deviation.max;
  result.rms = deviation.rms;
  if (deviation.worst >= 0) result.where = samples[deviation.worst].point;
  return result;
}

}  // namespace trimquad
