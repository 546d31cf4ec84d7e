#include "trimquad/spline/tangent_sheets.h"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

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
/// How far the strip goes on beyond the curve's ends, where the model's corners may lie off them: by its
/// width.
constexpr double kBeyondEnds[] = {1, 2, 4};

/// What one sheet has to move by to lie on the other, near one sample of their common curve.
class StripMoves {
 public:
  StripMoves(const SampledCurve& sampled, int stillSide, const Sheet& still, const Sheet& moving)
      : sampled_(sampled), stillSide_(stillSide), still_(still), moving_(moving) {}

  /// \param along, across way from the sample, model units
  void append(std::size_t i, double along, double across, std::vector<SurfaceMove>& moves) const {
    Eigen::Vector2d x = still_.footPoint(sampled_.point[i], sampled_.foot[stillSide_][i]);
    const auto jet = still_.jet(x);
    const Eigen::Vector3d t = direction(i), n = normal(jet);
    Eigen::Matrix<double, 3, 2> m;
    m << jet.su, jet.sv;
    x += m.colPivHouseholderQr().solve(along * t + across * n.cross(t));
    if (!within(still_, x)) return;
    const Eigen::Vector3d p = still_.jet(x).s;
    const Eigen::Vector2d y = moving_.footPoint(p, sampled_.foot[1 - stillSide_][i]);
    const auto at = moving_.jet(y);
    if (across != 0 && n.cross(at.su.cross(at.sv).normalized()).norm() > kSharp) return;
    const Eigen::Vector3d by = p - at.s;
    // Beyond the sheet's end there is no foot.
    const double sliding =
        std::max(std::abs(by.dot(at.su.normalized())), std::abs(by.dot(at.sv.normalized())));
    constexpr double rounding = 1e-9;
    if (sliding > 1e-3 * by.norm() + rounding) return;
    m << at.su, at.sv;
    const Eigen::Vector2d run = m.colPivHouseholderQr().solve(t);
    const std::size_t before = i == 0 ? 0 : i - 1, after = std::min(i + 1, sampled_.s.size() - 1);
    const double length = run.norm() * (sampled_.s[after] - sampled_.s[before]) / 2;
    const bool exact = along == 0 && across == 0;
    moves.push_back({y, by, run, exact ? length : kBesideWeight * length, exact});
  }

 private:
  Eigen::Vector3d direction(std::size_t i) const {
    const std::size_t before = i == 0 ? 0 : i - 1, after = std::min(i + 1, sampled_.s.size() - 1);
    return (sampled_.point[after] - sampled_.point[before]).normalized();
  }
  static bool within(const Sheet& sheet, const Eigen::Vector2d& x) {
    const auto& s = sheet.surface;
    return (sheet.period || (x[0] >= s.firstU() && x[0] <= s.lastU())) && x[1] >= s.firstV() &&
           x[1] <= s.lastV();
  }

  const SampledCurve& sampled_;
  int stillSide_;
  const Sheet& still_;
  const Sheet& moving_;
};

void appendMoves(const StripMoves& strip, std::size_t samples, double width,
                 std::vector<SurfaceMove>& moves) {
  for (std::size_t i = 0; i < samples; ++i)
    for (const int line : {-1, 0, 1}) strip.append(i, 0, line * width, moves);
  for (const double beyond : kBeyondEnds)
    for (const int line : {-1, 0, 1}) {
      strip.append(0, -beyond * width, line * width, moves);
      strip.append(samples - 1, beyond * width, line * width, moves);
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
  std::vector<int> moved;
  for (int k = 0; k < int(sheets.size()); ++k) {
    if (!mayMove[k]) continue;
    progress.check();
    std::vector<SurfaceMove> moves;
    for (const auto& curve : curves)
      for (const int side : {0, 1}) {
        const int still = curve.sheet[1 - side];
        if (curve.sheet[side] != k || !(rank(still) < rank(k))) continue;
        appendMoves(StripMoves(*curve.sampled, 1 - side, sheets[still], sheets[k]), curve.sampled->s.size(),
                    width, moves);
      }
    const bool touches = std::any_of(curves.begin(), curves.end(), [&](const TangentCurve& curve) {
      return curve.sheet[0] == k || curve.sheet[1] == k;
    });
    for (const auto& corner : corners)
      if (touches) appendCornerMove(corner, k, sheets, rank, moves);
    if (moves.empty()) continue;
    const int poles = int(sheets[k].surface.poles.size());
    auto surface = movedSurface(sheets[k].surface, moves, gap, kMorePoles * poles + kFewPoles, progress);
    if (!surface || !accepts(k, *surface)) continue;
    sheets[k].surface = std::move(*surface);
    moved.push_back(k);
  }
  return moved;
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
