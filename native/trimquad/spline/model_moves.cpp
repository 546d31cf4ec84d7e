// Surfaces that are moved to agree with their neighbours: ModelTrimmer's part that does it.

#include <algorithm>
#include <map>
#include <set>

#include "trimquad/spline/model_trimmer.h"
#include "trimquad/spline/moved_deviation.h"

namespace trimquad {
namespace {

/// Half of the width of the strip in which sheets that touch come to be nearly tangent, by the tolerance.
constexpr double kStripWidth = 0.1;
/// Part of the gap that sheets which bend sharply are joined to.
constexpr double kFinerGap = 0.1;
/// How far a region may be from a surface that was moved to agree with its neighbours, by the tolerance, as
/// long as there are other ways.
constexpr double kMovedDeviation = 1.2;
/// By how much sheets may miss a curve where they make no edge: so little that OpenCASCADE's own tolerance
/// covers it, model units.
constexpr double kTangentError = 0.3 * kSmallestTolerance;

}  // namespace

/// Of all that its deviation from a surface depends on.
long ModelTrimmer::numberOfRegion(int r) const {
  const Region& region = model_.regions[r];
  const auto& mesh = maps_[r]->mesh;
  ByteKey key;
  key.add(region.surface.get());
  for (const auto v : mesh.vertices()) key.add(mesh.point(v));
  for (const auto h : mesh.halfedges())
    key.add(mesh.to_vertex_handle(h).idx()).add(mesh.face_handle(h).idx());
  const Chart& chart = fitted_[r]->chart;
  key.add(chart.scale.bits).add(chart.period.value_or(0));
  for (const auto& corner : chart.corner) key.add(corner.u).add(corner.v);
  return memory_.numberOf("region", std::move(key));
}

/// The sheets by region; those of several charts can move where what joins them is known.
std::vector<SheetBody> ModelTrimmer::bodies() const {
  std::vector<SheetBody> result;
  for (int r = 0; r < int(fitted_.size()); ++r) {
    if (!fitted_[r]) continue;
    SheetBody body{firstSheet_[r], 1};
    if (const FittedSurface& fit = *fitted_[r]; fit.layout) {
      body.count = int(fit.surfaces.size());
      body.layout = &*fit.layout;
      if (fit.continuation) body.knots = &fit.continuation->knots;
    }
    result.push_back(body);
  }
  return result;
}

/// How far samples of a region lie from a surface. \param key of the samples and the surface
/// \param samples gives them, where this is not known yet
template <class Samples>
ChartDeviation ModelTrimmer::measured(int r, const SplineSurface& surface, ByteKey key,
                                      const Samples& samples) const {
  // The true surface is kept, so that its address means no other.
  using Measured = std::pair<ChartDeviation, std::shared_ptr<const TrueSurface>>;
  key.add(memory_.numberOf(surface));
  const auto measure = [&] {
    return Measured(deviationFrom(surface, samples(), threads_, progress_), model_.regions[r].surface);
  };
  return memory_.recall<Measured>("deviation", std::move(key), measure).first;
}

/// Samples of a region, made once. \param key of what they follow from
template <class Make>
auto ModelTrimmer::keptSamples(int r, const ByteKey& key, const Make& make) const {
  using Made = std::shared_ptr<const decltype(make())>;
  using Samples = std::pair<Made, std::shared_ptr<const TrueSurface>>;
  return memory_
      .recall<Samples>("samples", key,
                       [&] {
                         return Samples(std::make_shared<const decltype(make())>(make()),
                                        model_.regions[r].surface);
                       })
      .first;
}

/// Of a region of one chart from a surface that may be its own; at as many samples as that surface's knots
/// ask for.
ChartDeviation ModelTrimmer::deviationOf(int r, const SplineSurface& surface) const {
  ByteKey key;
  key.add(numberOfRegion(r));
  return measured(r, surface, std::move(key), [&] {
    return samplesFor(surface, model_.regions[r], *maps_[r], fitted_[r]->chart, threads_, progress_);
  });
}

/// The same of one of a region's several charts.
ChartDeviation ModelTrimmer::deviationOfChart(int r, int chart, const SplineSurface& surface) const {
  const FittedSurface& fit = *fitted_[r];
  ByteKey key;
  key.add(numberOfRegion(r));
  for (const auto& s : fit.surfaces) key.add(memory_.numberOf(s));
  const auto make = [&] { return samplesByChart(fit, model_.regions[r], *maps_[r], threads_, progress_); };
  ByteKey ofChart = key;
  ofChart.add(chart);
  return measured(r, surface, std::move(ofChart), [&] { return (*keptSamples(r, key, make))[chart]; });
}

/// How far a sheet's region, or chart of it, is from this surface.
/// Single surfaces are measured between the samples of their fit, too: moved ones have more knots than that.
ChartDeviation ModelTrimmer::deviationOfSheet(int sheet, const SplineSurface& surface) const {
  const int r = sheetRegion_[sheet];
  return borders_[r] ? deviationOfChart(r, sheet - firstSheet_[r], surface) : deviationOf(r, surface);
}

/// Whether sheets of a region may become these surfaces.
bool ModelTrimmer::acceptsMoved(const std::map<int, SplineSurface>& surfaces, bool lastResort) const {
  const int r = sheetRegion_[surfaces.begin()->first];
  const double most = std::max(lastResort ? enough_ : kMovedDeviation * tolerance_, fitted_[r]->maxDeviation);
  return std::all_of(surfaces.begin(), surfaces.end(), [&](const auto& ofSheet) {
    return deviationOfSheet(ofSheet.first, ofSheet.second).max <= most;
  });
}

SheetMover ModelTrimmer::mover() const {
  const auto accepts = [&](int, const std::map<int, SplineSurface>& surfaces, bool lastResort) {
    return acceptsMoved(surfaces, lastResort);
  };
  return SheetMover(bodies(), memory_, accepts, progress_);
}

std::map<int, std::vector<SplineModel::MovedSurface>> ModelTrimmer::movedRegions() const {
  std::map<int, std::vector<SplineModel::MovedSurface>> result;
  for (int sheet = 0; sheet < int(sheets_.size()); ++sheet) {
    const auto& surface = sheets_[sheet].surface;
    if (const int r = sheetRegion_[sheet]; moved_.contains(r))
      result[r].push_back({surface, deviationOfSheet(sheet, surface)});
  }
  return result;
}

/// Where on its chart's sheet a border of the run's region ends together with the run.
std::optional<Eigen::Vector2d> ModelTrimmer::borderEnd(const BoundaryRun& run, const RunEnd& end) const {
  const auto& lines = borders_[run.region];
  if (!lines) return {};
  const int point = layoutPoint({cornerOf(end), sheetOf(run), end.vertex, end.point, {}, {}, {}});
  if (point < 0) return {};
  for (const auto& e : lines->endsAt(point))
    for (const int side : {0, 1})
      if (const SheetLine line = lines->line(e.border, side); line.sheet == &sheets_[sheetOf(run)])
        return line.at(lines->endOf(e));
  return {};
}

/// Moves surfaces so that all around a corner of the model meet there.
void ModelTrimmer::meetInCorners() {
  std::map<int, SheetCorner> corners;
  std::set<std::tuple<int, int, int>> known;  // corner, sheet, vertex
  for (const auto& run : runs_)
    for (const bool atStart : {true, false}) {
      const RunEnd& end = atStart ? run.start : run.end;
      const int sheet = sheetOf(run), id = cornerOf(end);
      if (id >= int(model_.corners.size()) || !known.insert({id, sheet, end.vertex}).second) continue;
      auto& corner = corners[id];
      corner.id = id;
      corner.point = model_.corners[id];
      const auto border = borderEnd(run, end);
      const Eigen::Vector2d at = border ? *border : atStart ? run.uv.front() : run.uv.back();
      corner.uses.push_back({sheet, at, border.has_value(), {}});
      const auto& surface = model_.regions[run.region].surface;
      if (!surface) continue;
      const auto jet = sheets_[sheet].jet(at);
      corner.uses.back().normal = surface->closestFacing(corner.point, jet.su.cross(jet.sv)).normal;
    }
  std::vector<SheetCorner> all;
  for (auto& [id, corner] : corners) all.push_back(std::move(corner));
  const SheetMover moves = mover();
  for (const int body : trimquad::meetInCorners(sheets_, all, kSmallestTolerance, moves))
    moved_.insert(sheetRegion_[moves.bodies()[body].first]);
}

/// The corners in which curves end along which sheets touch, with all sheets around them.
std::vector<SheetCorner> ModelTrimmer::tangentCorners() const {
  std::map<int, SheetCorner> corners;
  for (const auto& [id, curve] : curves_)
    if (curve.sides.size() == 2 && !curve.intersection)
      for (const auto& end : {curve.sides[0].run->start, curve.sides[0].run->end}) corners[cornerOf(end)];
  for (const auto& [id, curve] : curves_)
    for (std::size_t k = 0; k < curve.sides.size(); ++k) {
      const auto& points = curve.samplesOf(k).point;
      const auto& feet = curve.feetOf(k);
      const BoundaryRun& run = *curve.sides[k].run;
      for (const bool atStart : {true, false}) {
        const auto corner = corners.find(cornerOf(atStart ? run.start : run.end));
        if (corner == corners.end()) continue;
        corner->second.point = pointOfCorner(corner->first, atStart ? points.front() : points.back());
        corner->second.uses.push_back({sheetOf(run), atStart ? feet.front() : feet.back(), false, {}});
      }
    }
  std::vector<SheetCorner> result;
  for (auto& [id, corner] : corners) {
    corner.id = id;
    result.push_back(std::move(corner));
  }
  return result;
}

/// Moves surfaces so that they agree with others that they touch, and samples their curves again.
/// Where sheets have no intersection then, they agree more closely, since where they bend sharply a fold says
/// where it is only so, and stay tangent around the corners there.
void ModelTrimmer::joinTangent() {
  std::map<int, double> gaps;
  for (const auto& [id, curve] : curves_)
    if (curve.sides.size() == 2 && !curve.intersection) gaps[id] = kTangentGap * model_.diagonal;
  const auto curves = curves_;
  const auto fitted = sheets_;
  const auto moved = moved_;
  const auto apart = joinTangent(gaps, {});
  if (apart.empty()) return;
  std::set<int> corners;
  for (const int id : apart) {
    const CurveWithSides& curve = curves_.at(id);
    if (curve.folded) gaps[id] *= kFinerGap;
    for (const RunEnd& end : {curve.sides[0].run->start, curve.sides[0].run->end})
      corners.insert(cornerOf(end));
  }
  curves_ = curves;
  sheets_ = fitted;
  moved_ = moved;
  joinTangent(gaps, corners);
}

/// \param gaps    by curve along which sheets touch: what may be left between them there, model units
/// \param corners around which sheets stay tangent where curves fix their tangent planes
/// Returns the curves that sheets were to be folded along but have no intersection.
std::vector<int> ModelTrimmer::joinTangent(const std::map<int, double>& gaps, const std::set<int>& corners) {
  std::vector<TangentCurve> tangent;
  const auto sideOf = [&](const SheetSide& side) {
    return TangentCurve::Side{sheetOf(*side.run), side.run->forward};
  };
  for (const auto& [id, gap] : gaps) {
    const auto& curve = curves_.at(id);
    const std::array<int, 2> ends{cornerOf(curve.sides[0].run->start), cornerOf(curve.sides[0].run->end)};
    tangent.push_back({&curve.sampled[0],
                       {sideOf(curve.sides[0]), sideOf(curve.sides[1])},
                       !curvePieces_->isPolyline(id),
                       gap,
                       ends,
                       {pointOfCorner(ends[0], curve.sampled[0].point.front()),
                        pointOfCorner(ends[1], curve.sampled[0].point.back())},
                       {corners.count(ends[0]) > 0, corners.count(ends[1]) > 0}});
  }
  const SheetMover moves = mover();
  const auto joined = joinTangentSheets(
      sheets_, tangent, tangentCorners(),
      {kStripWidth * tolerance_, kTangentGap * model_.diagonal, kTangentError}, threads_, moves);
  for (const int body : joined.moved) moved_.insert(sheetRegion_[moves.bodies()[body].first]);
  numberSheets();
  std::size_t number = 0;
  for (const auto& [id, gap] : gaps) {
    curves_.at(id).folded = joined.folded[number];
    curves_.at(id).tangent = joined.tangent[number++];
  }
  const auto hasMoved = [&](const SheetSide& side) {
    return std::binary_search(joined.moved.begin(), joined.moved.end(), moves.bodyOf(sheetOf(*side.run)));
  };
  forEachCurve([&](int id, CurveWithSides& curve) {
    if (std::none_of(curve.sides.begin(), curve.sides.end(), hasMoved)) return;
    sample(id, curve);
    if (curve.intersection || curve.folded) intersect(curve);
  });
  std::vector<int> apart;
  for (const auto& [id, gap] : gaps) {
    const CurveWithSides& curve = curves_.at(id);
    const SheetBody &first = moves.ofSheet(sheetOf(*curve.sides[0].run)),
                    &second = moves.ofSheet(sheetOf(*curve.sides[1].run));
    const bool both = first.mayMove() && second.mayMove();
    if (both && !curvePieces_->isPolyline(id) && !curve.intersection) apart.push_back(id);
  }
  return apart;
}

}  // namespace trimquad
