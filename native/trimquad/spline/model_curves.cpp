// The curves along which a model's surfaces end: ModelTrimmer's part that finds them.

#include <algorithm>

#include "trimquad/spline/model_trimmer.h"

namespace trimquad {
namespace {

/// Part of a distance from a corner below which another one is far less.
constexpr double kFarNearer = 0.5;

/// Parts of the tolerance within which edges follow their curves, as seen on the sheet; and chains of mesh
/// edges in space, so that their teeth are smoothed.
constexpr double kCloseness = 0.25, kChainCloseness = 0.9;
/// The same for the edge of sheets that touch.
constexpr double kTouchCloseness = 0.05;
/// How far an edge may be from its curve where that lies beyond both sheets, by what is enough for these:
/// less than sheets that cross at right angles leave between them.
constexpr double kStrays = 1.25;

void addTo(ByteKey& key, const std::vector<TangentStretch>& stretches) {
  key.add(stretches.size());
  for (const auto& stretch : stretches) key.add(stretch.first).add(stretch.last).add(stretch.blend);
}

}  // namespace

/// Of the samples and the sheets that a step goes from.
ByteKey ModelTrimmer::keyOf(const SampledCurve& sampled, const std::vector<SheetSide>& sides) const {
  ByteKey key;
  key.add(sampled.curve->curve.get()).add(sampled.curve->start == sampled.curve->end);
  key.add(sampled.t).add(sampled.s).add(sampled.point).add(sampled.foot);
  for (const auto& side : sides) key.add(sheetNumbers_[sheetOf(*side.run)]);
  return key;
}

void ModelTrimmer::sample(int id, CurveWithSides& curve) const {
  // A sheet lies within the tolerance of its region; twenty times as much is another place of it.
  const double reach = 20 * tolerance_ + 1e-9 * model_.diagonal;
  const ModelCurve& piece = (*curvePieces_)[id];
  progress_.check();
  curve.sampled.clear();
  const auto sampled = [&](const std::vector<SheetSide>& sides) {
    ByteKey key;
    key.add(piece.curve.get()).add(reach);
    for (const auto& side : sides)
      key.add(sheetNumbers_[sheetOf(*side.run)]).add(side.run->t).add(side.run->uv);
    // The true curve is kept, so that its address means no other.
    using Sampled = std::pair<SampledCurve, std::shared_ptr<const TrueCurve>>;
    curve.sampled.push_back(
        memory_
            .recall<Sampled>("sample", std::move(key),
                             [&] { return Sampled(sampleCurve(piece, sides, reach), piece.curve); })
            .first);
    curve.sampled.back().curve = &piece;
  };
  if (curve.sides.size() == 2)
    sampled(curve.sides);
  else
    for (const auto& side : curve.sides) sampled({side});
}

/// A sheet that turns back just beyond its trim passes a corner twice, and the map may have it on the way
/// back, and one of the two boundary runs that end there as well: both are led to where the samples come to
/// the corner, if the sheet is far nearer there.
void ModelTrimmer::settleRunEnds() {
  struct End {
    BoundaryRun* run;
    bool atStart;
    int curve;
    Eigen::Vector2d foot;
    double distance, byMap;  ///< of the foot; of the one that is reached from the map's parameters
  };
  std::map<std::tuple<int, int, int>, std::vector<End>> ends;  // by corner, sheet, vertex
  const auto collect = [&](int id, const CurveWithSides& curve, std::size_t side) {
    BoundaryRun& run = runs_[curve.sides[side].run - runs_.data()];
    const Sheet& sheet = sheets_[sheetOf(run)];
    const auto& feet = curve.feetOf(side);
    const auto& points = curve.samplesOf(side).point;
    for (const bool atStart : {true, false}) {
      const RunEnd& end = atStart ? run.start : run.end;
      const Eigen::Vector2d& foot = atStart ? feet.front() : feet.back();
      const Eigen::Vector3d& point = atStart ? points.front() : points.back();
      const auto away = [&](const Eigen::Vector2d& x) { return (sheet.jet(x).s - point).norm(); };
      ends[{cornerOf(end), sheetOf(run), end.vertex}].push_back(
          {&run, atStart, id, foot, away(foot),
           away(sheet.footPoint(point, atStart ? run.uv.front() : run.uv.back()))});
    }
  };
  for (const auto& [id, curve] : curves_)
    for (std::size_t side = 0; side < curve.sides.size(); ++side) collect(id, curve, side);
  std::set<int> led;
  for (const auto& [corner, found] : ends) {
    const End& nearest = *std::min_element(
        found.begin(), found.end(), [](const End& a, const End& b) { return a.distance < b.distance; });
    for (const End& end : found) {
      if (end.byMap <= kComposedError || !(nearest.distance < kFarNearer * end.byMap)) continue;
      Eigen::Vector2d& uv = end.atStart ? end.run->uv.front() : end.run->uv.back();
      Eigen::Vector2d foot = nearest.foot;
      if (const auto& period = sheets_[sheetOf(*end.run)].period)
        foot[0] += *period * std::round((uv[0] - foot[0]) / *period);
      uv = foot;
      led.insert(end.curve);
    }
  }
  forEachCurve([&](int id, CurveWithSides& curve) {
    if (led.contains(id)) sample(id, curve);
  });
}

void ModelTrimmer::intersect(CurveWithSides& curve) const {
  if (curve.sides.size() != 2) return;
  const double smallestAngle = curve.folded ? kSmallestFold : kSmallestCrossing;
  ByteKey key = keyOf(curve.sampled.front(), curve.sides);
  key.add(tolerance_).add(reach_).add(smallestAngle);
  addTo(key, curve.tangent);
  curve.intersection = memory_.recall<std::optional<IntersectionCurve>>("intersect", std::move(key), [&] {
    return intersectionCurve(curve.sampled.front(), curve.sides, tolerance_, reach_, smallestAngle,
                             curve.tangent, progress_);
  });
  if (curve.intersection) curve.intersection->setSheets(*curve.sides[0].sheet, *curve.sides[1].sheet);
}

/// The edges along a curve: one that its two sheets share, or one a sheet.
std::vector<ModelTrimmer::CurveEdge> ModelTrimmer::edgesOf(int id, const CurveWithSides& curve,
                                                           const std::vector<double>& tolerances) const {
  progress_.check();
  std::vector<CurveEdge> result;
  if (curve.sides.size() != 2) {
    for (std::size_t k = 0; k < curve.sides.size(); ++k) {
      const SheetSide& side = curve.sides[k];
      result.push_back({freeEdgeOf(id, curve.sampled[k], side, tolerances[side.run->region]), {&side}});
    }
    return result;
  }
  const SheetSide &a = curve.sides[0], &b = curve.sides[1];
  std::optional<std::vector<TrimPiece>> edge;
  if (curve.intersection) {
    const auto& piece = (*curvePieces_)[id];
    const auto& start = vertices_[groupOf(*a.run, a.run->start)].point;
    const auto& end = vertices_[groupOf(*a.run, a.run->end)].point;
    ByteKey key = keyOf(curve.sampled.front(), curve.sides);
    key.add(tolerance_).add(reach_).add(curve.folded).add(start).add(end);
    addTo(key, curve.tangent);
    for (const auto& side : curve.sides) key.add(side.start).add(side.end);
    edge = memory_.recall<std::optional<std::vector<TrimPiece>>>("shared edge", std::move(key), [&] {
      return sharedEdge(*curve.intersection, piece.start == piece.end, start, end, curve.sides, progress_);
    });
  }
  const double looseGap = kLooseGap * model_.diagonal;
  const auto gapOf = [](const std::vector<TrimPiece>& pieces) {
    double gap = 0;
    for (const auto& piece : pieces) gap = std::max(gap, piece.gap);
    return gap;
  };
  bool loose = !edge;
  // Sheets that are tangent somewhere may have an intersection that turns back there.
  if (loose || gapOf(*edge) > looseGap) {
    try {
      auto touching = looseEdgeOf(curve, tolerances);
      loose = loose || gapOf(touching) < gapOf(*edge);
      if (loose) edge = std::move(touching);
    } catch (const Error& error) {
      if (loose || error.kind() != Error::Kind::Stage) throw;
    }
  }
  for (auto& piece : *edge) exposeGap(piece, curve.sides, kSmallestTolerance, looseGap);
  const bool strays = !loose && this->strays(curve, *edge);
  result.push_back({std::move(*edge), {&a, &b}, strays});
  return result;
}

/// The edge of two sheets along a curve that they only touch along.
std::vector<TrimPiece> ModelTrimmer::looseEdgeOf(const CurveWithSides& curve,
                                                 const std::vector<double>& tolerances) const {
  const SampledCurve& sampled = curve.sampled.front();
  const auto within = [&](double near) {
    ByteKey key = keyOf(sampled, curve.sides);
    for (const auto& side : curve.sides) key.add(side.start).add(side.end);
    key.add(near);
    return memory_.recall<std::vector<TrimPiece>>(
        "loose edge", std::move(key), [&] { return looseEdge(sampled, curve.sides, near, progress_); });
  };
  const double near = kTouchCloseness * std::min(tolerances[curve.sides[0].run->region],
                                                 tolerances[curve.sides[1].run->region]);
  // Sheets that agree do so on the curve itself; where it cannot be followed so closely, not as well.
  if (sampled.apart(curve.sides) < kLooseGap * model_.diagonal) {
    try {
      return within(std::min(near, kTangentGap * model_.diagonal));
    } catch (const Error& error) {
      if (error.kind() != Error::Kind::Stage) throw;
    }
  }
  return within(near);
}

/// Whether the edge that two sheets share leaves a place of its curve beyond both of them, and far away:
/// where their surfaces make a sharp wedge, each may be close to its region and their intersection not.
bool ModelTrimmer::strays(const CurveWithSides& curve, const std::vector<TrimPiece>& edge) const {
  const SampledCurve& sampled = curve.sampled.front();
  auto piece = edge.begin();
  for (std::size_t i = 0; i < sampled.s.size(); ++i) {
    while (sampled.s[i] > piece->curve.last() && std::next(piece) != edge.end()) ++piece;
    // Parameters slide along curves that are fitted.
    const double s = nearestParameter(piece->curve, sampled.point[i], sampled.s[i]);
    if (!(s > piece->curve.first() && s < piece->curve.last())) continue;  // another piece's, or a corner's
    if ((piece->curve.point(s) - sampled.point[i]).norm() <= kStrays * enough_) continue;
    const auto isBeyond = [&](int side) {
      const auto x = piece->onSheet[side].derivatives(s, 1);
      const Eigen::Vector2d way = sampled.foot[side][i] - x[0];
      const double left = x[1][0] * way[1] - x[1][1] * way[0];
      return curve.sides[side].run->forward ? left < 0 : left > 0;
    };
    if (isBeyond(0) && isBeyond(1)) return true;
  }
  return false;
}

std::vector<TrimPiece> ModelTrimmer::freeEdgeOf(int id, const SampledCurve& sampled, const SheetSide& side,
                                                double tolerance) const {
  const double onSheet = kCloseness * tolerance;
  const CurveCloseness closeness{onSheet,
                                 curvePieces_->isPolyline(id) ? kChainCloseness * tolerance : onSheet};
  ByteKey key = keyOf(sampled, {side});
  key.add(side.start).add(side.end).add(closeness.onSheet).add(closeness.inSpace);
  return memory_.recall<std::vector<TrimPiece>>(
      "free edge", std::move(key), [&] { return freeEdge(sampled, side, closeness, progress_); });
}

}  // namespace trimquad
