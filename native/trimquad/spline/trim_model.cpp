#include "trimquad/spline/trim_model.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "trimquad/base/error.h"
#include "trimquad/spline/model_trimmer.h"
#include "trimquad/spline/moved_deviation.h"
#include "trimquad/spline/tangent_sheets.h"

namespace trimquad {
namespace {

constexpr double kSmallestTolerance = 1e-7;
constexpr double kSheetSlack = 0.5;  ///< quads
/// Parts of the tolerance within which edges follow their curves, as seen on the sheet; and chains of mesh
/// edges in space, so that their teeth are smoothed.
constexpr double kCloseness = 0.25, kChainCloseness = 0.9;
/// Parts of the tolerance: how closely the edge of sheets that touch follows its curve, on which they are
/// made to agree, and half of the width of the strip in which they nearly do.
constexpr double kTouchCloseness = 0.05, kStripWidth = 0.1;
/// Part of the gap that sheets which bend sharply are joined to.
constexpr double kFinerGap = 0.1;
/// How far a region may be from a surface that was moved to agree with its neighbours, by the tolerance, as
/// long as there are other ways.
constexpr double kMovedDeviation = 1.2;
/// Edges between touching sheets that are further apart, by the model's diagonal, are loose.
constexpr double kLooseGap = 5 * kTangentGap;
/// Shorter curves vanish: their ends become one vertex.
constexpr double kShortestEdge = 10 * kSmallestTolerance;

}  // namespace

void ModelTrimmer::makeSheets() {
  for (int r = 0; r < int(fitted_.size()); ++r) {
    firstSheet_.push_back(int(sheets_.size()));
    const FittedSurface* fit = fitted_[r];
    if (fit && fit->layout) {
      for (const auto& surface : fit->surfaces) sheets_.push_back({surface, {}, kSheetSlack});
    } else if (fit) {
      auto& sheet = sheets_.emplace_back();
      sheet.surface = fit->surface;
      if (fit->surface.closedU) sheet.period = fit->surface.lastU() - fit->surface.firstU();
    }
    sheetRegion_.resize(sheets_.size(), r);
  }
  for (int r = 0; r < int(fitted_.size()); ++r) {
    auto& lines = borders_.emplace_back();
    if (fitted_[r] && fitted_[r]->layout) lines.emplace(*fitted_[r]->layout, &sheets_[firstSheet_[r]]);
  }
}

void ModelTrimmer::numberSheets() {
  sheetNumbers_.clear();
  for (const auto& sheet : sheets_) sheetNumbers_.push_back(memory_.numberOf(sheet.surface));
}

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

/// Of all that a step depends on that goes from samples to curves on the sheets.
ByteKey ModelTrimmer::keyOf(const SampledCurve& sampled, const std::vector<SheetSide>& sides) const {
  ByteKey key;
  key.add(sampled.curve->curve.get()).add(sampled.curve->start == sampled.curve->end);
  key.add(sampled.t).add(sampled.s).add(sampled.point).add(sampled.foot);
  for (const auto& side : sides) key.add(sheetNumbers_[sheetOf(*side.run)]).add(side.start).add(side.end);
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

void ModelTrimmer::intersect(CurveWithSides& curve) const {
  if (curve.sides.size() != 2) return;
  const double smallestAngle = curve.folded ? kSmallestFold : kSmallestCrossing;
  ByteKey key = keyOf(curve.sampled.front(), curve.sides);
  key.add(tolerance_).add(reach_).add(smallestAngle);
  curve.intersection = memory_.recall<std::optional<IntersectionCurve>>("intersect", std::move(key), [&] {
    return intersectionCurve(curve.sampled.front(), curve.sides, tolerance_, reach_, smallestAngle,
                             progress_);
  });
  if (curve.intersection) curve.intersection->setSheets(*curve.sides[0].sheet, *curve.sides[1].sheet);
}

/// Moves the places where borders end on model curves: to where the foot of the curve's point on the fitted
/// surface passes over the border's line.
void ModelTrimmer::settleSplits(std::vector<CurveSplit>& splits) {
  for (auto& split : splits) {
    const auto& ends = borders_[split.region]->endsAt(split.point);
    if (ends.size() != 1) continue;
    const TrueCurve& curve = *model_.curves[split.curve.index].curve;
    // At most half way to the other ends of all runs that end here, to keep their order.
    double low = curve.first(), high = curve.last();
    for (const auto& run : runs_) {
      const double middle = (run.t.front() + run.t.back()) / 2;
      if (run.start.corner == split.corner) high = std::min(high, middle);
      if (run.end.corner == split.corner) low = std::max(low, middle);
    }
    split.t = borders_[split.region]->placeOnCurve(ends[0], curve, split.t, low, high);
    for (auto& run : runs_) {
      if (run.start.corner == split.corner) startAt(run, split.t, curve.point(split.t));
      if (run.end.corner == split.corner) endAt(run, split.t, curve.point(split.t));
    }
  }
}

void ModelTrimmer::collectRuns() {
  int corners = int(model_.corners.size());
  std::vector<CurveSplit> splits;
  for (int r = 0; r < int(model_.regions.size()); ++r) {
    if (!fitted_[r]) continue;
    const auto runs = fitted_[r]->layout ? boundaryRuns(model_, r, *fitted_[r]->layout, corners, splits)
                                         : boundaryRuns(model_, r, fitted_[r]->chart);
    runs_.insert(runs_.end(), runs.begin(), runs.end());
  }
  DisjointSets together(corners);
  settleSplits(splits);
  cutAtSplits(model_, splits, runs_);
  std::stable_sort(runs_.begin(), runs_.end(), [](const BoundaryRun& a, const BoundaryRun& b) {
    return std::tuple(a.region, a.chart, a.place) < std::tuple(b.region, b.chart, b.place);
  });
  curvePieces_.emplace(model_, splits);
  const auto tooShort = [&](const BoundaryRun& run) {
    double length = 0;
    for (std::size_t i = 0; i + 1 < run.points.size(); ++i)
      length += (run.points[i] - run.points[i + 1]).norm();
    return length < kShortestEdge;
  };
  for (const auto& run : runs_)
    if (tooShort(run)) together.unite(run.start.corner, run.end.corner);
  std::erase_if(runs_, tooShort);
  for (int c = 0; c < corners; ++c) corners_.push_back(together.root(c));
  for (const auto& run : runs_)
    curves_[curvePieces_->pieceOf(run)].sides.push_back(
        {&sheets_[sheetOf(run)], &run, model_.regions[run.region].name, {}, {}});
}

/// By sheet: whether its surface may move. Those of one region are joined to each other.
std::vector<char> ModelTrimmer::mayMove() const {
  std::vector<char> single;
  for (const int r : sheetRegion_) single.push_back(!borders_[r]);
  return single;
}

/// Of a region of one chart from a surface that may be its own; at samples that follow from the region and
/// its fit, or as many as that surface's knots ask for.
ChartDeviation ModelTrimmer::deviationOf(int r, const SplineSurface& surface, bool closely) const {
  const Region& region = model_.regions[r];
  // The true surface is kept, so that its address means no other.
  using Known = std::shared_ptr<const TrueSurface>;
  const SplineSurface& dense = closely ? surface : fitted_[r]->surface;
  ByteKey key;
  key.add(numberOfRegion(r)).add(memory_.numberOf(dense));
  const auto samples = [&] {
    using Samples = std::pair<std::shared_ptr<const std::vector<SurfaceSample>>, Known>;
    const auto make = [&] {
      return std::make_shared<const std::vector<SurfaceSample>>(
          samplesFor(dense, region, *maps_[r], fitted_[r]->chart, threads_, progress_));
    };
    if (closely) return make();
    return memory_.recall<Samples>("samples", key, [&] { return Samples(make(), region.surface); }).first;
  };
  ByteKey ofSurface = key;
  ofSurface.add(memory_.numberOf(surface));
  using Measured = std::pair<ChartDeviation, Known>;
  return memory_
      .recall<Measured>(
          "deviation", std::move(ofSurface),
          [&] { return Measured(deviationFrom(surface, *samples(), threads_, progress_), region.surface); })
      .first;
}

/// Whether a sheet may become this surface.
bool ModelTrimmer::acceptsMoved(int sheet, const SplineSurface& surface, bool lastResort) {
  const int r = sheetRegion_[sheet];
  if (!(deviationOf(r, surface, false).max <=
        std::max(lastResort ? enough_ : kMovedDeviation * tolerance_, fitted_[r]->maxDeviation)))
    return false;
  moved_.insert(r);
  return true;
}

std::map<int, ChartDeviation> ModelTrimmer::movedRegions() const {
  std::map<int, ChartDeviation> result;
  for (const int r : moved_) result[r] = deviationOf(r, sheets_[firstSheet_[r]].surface, true);
  return result;
}

/// Moves single surfaces so that all around a corner of the model meet there.
void ModelTrimmer::meetInCorners() {
  std::map<int, SheetCorner> corners;
  std::set<std::tuple<int, int, int>> known;  // corner, sheet, vertex
  for (const auto& run : runs_)
    for (const bool atStart : {true, false}) {
      const RunEnd& end = atStart ? run.start : run.end;
      const int sheet = sheetOf(run), id = cornerOf(end);
      if (id >= int(model_.corners.size()) || !known.insert({id, sheet, end.vertex}).second) continue;
      auto& corner = corners[id];
      corner.point = model_.corners[id];
      const Eigen::Vector2d at = atStart ? run.uv.front() : run.uv.back();
      corner.uses.push_back({sheet, at, {}});
      const auto& surface = model_.regions[run.region].surface;
      if (!surface) continue;
      const auto jet = sheets_[sheet].jet(at);
      corner.uses.back().normal = surface->closestFacing(corner.point, jet.su.cross(jet.sv)).normal;
    }
  std::vector<SheetCorner> all;
  for (auto& [id, corner] : corners) all.push_back(std::move(corner));
  trimquad::meetInCorners(sheets_, all, mayMove(), kSmallestTolerance,
                          {memory_,
                           [&](int sheet, const SplineSurface& surface, bool lastResort) {
                             return acceptsMoved(sheet, surface, lastResort);
                           },
                           progress_});
}

/// The corners in which curves end along which sheets touch, with all sheets around them.
std::vector<SheetCorner> ModelTrimmer::tangentCorners() const {
  std::map<int, SheetCorner> corners;
  for (const auto& [id, curve] : curves_)
    if (curve.sides.size() == 2 && !curve.intersection)
      for (const auto& end : {curve.sides[0].run->start, curve.sides[0].run->end}) corners[cornerOf(end)];
  for (const auto& [id, curve] : curves_)
    for (std::size_t k = 0; k < curve.sides.size(); ++k) {
      const auto& sampled = curve.sampled[curve.sides.size() == 2 ? 0 : k];
      const auto& feet = sampled.foot[curve.sides.size() == 2 ? k : 0];
      const BoundaryRun& run = *curve.sides[k].run;
      for (const bool atStart : {true, false}) {
        const auto corner = corners.find(cornerOf(atStart ? run.start : run.end));
        if (corner == corners.end()) continue;
        corner->second.point = atStart ? sampled.point.front() : sampled.point.back();
        corner->second.uses.push_back({sheetOf(run), atStart ? feet.front() : feet.back()});
      }
    }
  std::vector<SheetCorner> result;
  for (auto& [id, corner] : corners) result.push_back(std::move(corner));
  return result;
}

/// Moves single surfaces so that they agree with others that they touch, and samples their curves again.
/// Where the surfaces bend sharply, a fold says where their intersection is only if they agree more closely.
void ModelTrimmer::joinTangent() {
  std::map<int, double> gaps;
  for (const auto& [id, curve] : curves_)
    if (curve.sides.size() == 2 && !curve.intersection) gaps[id] = kTangentGap * model_.diagonal;
  const auto curves = curves_;
  const auto fitted = sheets_;
  const auto moved = moved_;
  const auto lost = joinTangent(gaps);
  if (lost.empty()) return;
  for (const int id : lost) gaps[id] *= kFinerGap;
  curves_ = curves;
  sheets_ = fitted;
  moved_ = moved;
  joinTangent(gaps);
}

/// \param gaps by curve along which sheets touch: what may be left between them there, model units
/// Returns the curves of folds that are not found.
std::vector<int> ModelTrimmer::joinTangent(const std::map<int, double>& gaps) {
  std::vector<TangentCurve> tangent;
  const auto sideOf = [&](const SheetSide& side) {
    return TangentCurve::Side{sheetOf(*side.run), side.run->forward};
  };
  for (const auto& [id, gap] : gaps) {
    const auto& curve = curves_.at(id);
    tangent.push_back({&curve.sampled[0],
                       {sideOf(curve.sides[0]), sideOf(curve.sides[1])},
                       !curvePieces_->isPolyline(id),
                       gap});
  }
  const auto joined = joinTangentSheets(sheets_, tangent, tangentCorners(), mayMove(),
                                        {kStripWidth * tolerance_, kTangentGap * model_.diagonal},
                                        {memory_,
                                         [&](int sheet, const SplineSurface& surface, bool lastResort) {
                                           return acceptsMoved(sheet, surface, lastResort);
                                         },
                                         progress_});
  numberSheets();
  auto folded = joined.folded.begin();
  for (const auto& [id, gap] : gaps) curves_.at(id).folded = *folded++;
  const auto hasMoved = [&](const SheetSide& side) {
    return std::binary_search(joined.moved.begin(), joined.moved.end(), sheetOf(*side.run));
  };
  forEachCurve([&](int id, CurveWithSides& curve) {
    if (std::none_of(curve.sides.begin(), curve.sides.end(), hasMoved)) return;
    sample(id, curve);
    if (curve.intersection || curve.folded) intersect(curve);
  });
  std::vector<int> lost;
  for (const auto& [id, curve] : curves_)
    if (curve.folded && !curve.intersection) lost.push_back(id);
  return lost;
}

PieceLoop ModelTrimmer::borderPiece(int region, const Layout::Stretch& stretch,
                                    const std::vector<SplineEdgeId>& edges) const {
  const auto& edge = borderEdges_[region][*stretch.border];
  const bool forward = stretch.forward != edge.reversed;
  return {{{edges[*stretch.border], forward, edge.onSheet[stretch.forward ? 0 : 1]},
           forward ? edge.edge.start : edge.edge.end,
           forward ? edge.edge.end : edge.edge.start}};
}

/// The edges along a curve: one that its two sheets share, or one a sheet.
std::vector<ModelTrimmer::CurveEdge> ModelTrimmer::edgesOf(int id, const CurveWithSides& curve,
                                                           const std::vector<double>& tolerances) const {
  progress_.check();
  std::vector<CurveEdge> result;
  if (curve.sides.size() != 2) {
    for (std::size_t k = 0; k < curve.sides.size(); ++k) {
      const SheetSide& side = curve.sides[k];
      result.push_back(
          {freeEdgeOf(id, curve.sampled[k], side, tolerances[side.run->region]), {&side}, false});
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
    edge = memory_.recall<std::optional<std::vector<TrimPiece>>>("shared edge", std::move(key), [&] {
      return sharedEdge(*curve.intersection, piece.start == piece.end, start, end, progress_);
    });
  }
  const bool loose = !edge;
  if (loose) {
    double near = kTouchCloseness * std::min(tolerances[a.run->region], tolerances[b.run->region]);
    // Sheets that agree do so on the curve itself.
    if (curve.sampled.front().apart(curve.sides) < kLooseGap * model_.diagonal)
      near = std::min(near, kTangentGap * model_.diagonal);
    ByteKey key = keyOf(curve.sampled.front(), curve.sides);
    key.add(near);
    edge = memory_.recall<std::vector<TrimPiece>>("loose edge", std::move(key), [&] {
      return looseEdge(curve.sampled.front(), curve.sides, near, progress_);
    });
  }
  result.push_back({std::move(*edge), {&a, &b}, loose});
  return result;
}

std::vector<TrimPiece> ModelTrimmer::freeEdgeOf(int id, const SampledCurve& sampled, const SheetSide& side,
                                                double tolerance) const {
  const double onSheet = kCloseness * tolerance;
  const CurveCloseness closeness{onSheet,
                                 curvePieces_->isPolyline(id) ? kChainCloseness * tolerance : onSheet};
  ByteKey key = keyOf(sampled, {side});
  key.add(closeness.onSheet).add(closeness.inSpace);
  return memory_.recall<std::vector<TrimPiece>>(
      "free edge", std::move(key), [&] { return freeEdge(sampled, side, closeness, progress_); });
}

SplineModel ModelTrimmer::trim(const std::vector<double>& tolerances) const {
  SplineModel result;
  for (const auto& vertex : vertices_) result.vertices.push_back({vertex.point, kSmallestTolerance});
  std::map<const BoundaryRun*, std::vector<LoopPiece>> pieces;
  const auto addEdge = [&](const CurveEdge& added) {
    const auto& [edge, sides, loose] = added;
    const BoundaryRun& first = *sides[0]->run;
    SplineVertexId start{groupOf(first, first.start)};
    for (std::size_t i = 0; i < edge.size(); ++i) {
      SplineVertexId end{groupOf(first, first.end)};
      if (i + 1 < edge.size()) {
        end = {int(result.vertices.size())};
        result.vertices.push_back({edge[i].curve.poles.back(), kSmallestTolerance});
      }
      const SplineEdgeId id{int(result.edges.size())};
      result.edges.push_back({edge[i].curve, start, end, std::max(kSmallestTolerance, 1.01 * edge[i].gap)});
      result.looseEdges += loose && edge[i].gap > kLooseGap * model_.diagonal;
      for (std::size_t k = 0; k < sides.size(); ++k) {
        const bool forward = sides[k]->run->forward;
        pieces[sides[k]->run].push_back(
            {{id, forward, edge[i].onSheet[k]}, forward ? start : end, forward ? end : start});
      }
      start = end;
    }
  };
  std::vector<std::pair<int, const CurveWithSides*>> all;
  for (const auto& [id, curve] : curves_) all.push_back({id, &curve});
  std::vector<std::vector<CurveEdge>> edgesOfCurves(all.size());
  RegionErrorList errors;
  errors.attemptEach(int(all.size()), threads_,
                     [&](int k) { edgesOfCurves[k] = edgesOf(all[k].first, *all[k].second, tolerances); });
  errors.raise();
  for (const auto& ofCurve : edgesOfCurves)
    for (const auto& edge : ofCurve) addEdge(edge);

  const auto appendFaces = [&](int sheet, const std::vector<PieceLoop>& loops) {
    const int r = sheetRegion_[sheet];
    errors.attempt([&] {
      for (auto& face : trimmedFaces(sheets_[sheet], loops, r, model_.regions[r].name, result)) {
        face.chart = sheet - firstSheet_[r];
        result.faces.push_back(std::move(face));
      }
    });
  };
  // By sheet, loop and stretch: the edges along the region's boundary.
  std::map<std::array<int, 3>, PieceLoop> stretches;
  for (const auto& run : runs_) {
    auto& part = pieces.at(&run);
    if (!run.forward) std::reverse(part.begin(), part.end());
    auto& stretch = stretches[{sheetOf(run), run.place[0], run.place[1]}];
    stretch.insert(stretch.end(), part.begin(), part.end());
  }
  for (int r = 0; r < int(fitted_.size()); ++r) {
    if (!fitted_[r]) continue;
    if (!borders_[r]) {
      std::vector<PieceLoop> loops;
      for (auto at = stretches.lower_bound({firstSheet_[r], 0, 0});
           at != stretches.end() && at->first[0] == firstSheet_[r]; ++at)
        loops.push_back(at->second);
      appendFaces(firstSheet_[r], loops);
      continue;
    }
    std::vector<SplineEdgeId> edges;
    for (const auto& edge : borderEdges_[r]) {
      edges.push_back({int(result.edges.size())});
      result.edges.push_back(edge.edge);
    }
    const auto& charts = fitted_[r]->layout->charts;
    for (int c = 0; c < int(charts.size()); ++c) {
      std::vector<PieceLoop> loops;
      for (int l = 0; l < int(charts[c].loops.size()); ++l) {
        auto& loop = loops.emplace_back();
        for (int k = 0; k < int(charts[c].loops[l].size()); ++k) {
          const auto& stretch = charts[c].loops[l][k];
          const auto part =
              stretch.border ? borderPiece(r, stretch, edges) : stretches[{firstSheet_[r] + c, l, k}];
          loop.insert(loop.end(), part.begin(), part.end());
        }
      }
      appendFaces(firstSheet_[r] + c, loops);
    }
  }
  errors.raise();

  for (const auto& face : result.faces)
    for (const auto& loop : face.loops)
      for (const auto& coedge : loop) {
        const SplineEdge& edge = result.edges[coedge.edge.index];

        for (const bool atStart : {true, false}) {
          SplineVertex& vertex = result.vertices[(atStart ? edge.start : edge.end).index];
          const Eigen::Vector3d inSpace = atStart ? edge.curve.poles.front() : edge.curve.poles.back();
          const Eigen::Vector2d x = atStart ? coedge.curve.poles.front() : coedge.curve.poles.back();
          const double off = std::max((inSpace - vertex.point).norm(),
                                      (face.surface.point(x[0], x[1]) - vertex.point).norm());
          vertex.tolerance = std::max({vertex.tolerance, 1.01 * off, edge.tolerance});
        }
      }
  appendShells(result);
  return result;
}

void ModelTrimmer::appendShells(SplineModel& result) const {
  for (const auto& shell : model_.shells) {
    std::vector<int> faces;
    for (int f = 0; f < int(result.faces.size()); ++f)
      if (std::count(shell.regions.begin(), shell.regions.end(), result.faces[f].region)) faces.push_back(f);
    // Connected parts, and whether each edge of them is used twice.
    std::vector<std::vector<int>> usersOf(result.edges.size());
    for (const int f : faces)
      for (const auto& loop : result.faces[f].loops)
        for (const auto& coedge : loop) usersOf[coedge.edge.index].push_back(f);
    DisjointSets connected(result.faces.size());
    for (const auto& users : usersOf)
      for (const int f : users) connected.unite(users.front(), f);
    std::map<int, SplineModel::Shell> parts;
    for (const int f : faces) parts[connected.root(f)].faces.push_back(f);
    const bool complete =
        std::all_of(shell.regions.begin(), shell.regions.end(), [&](int r) { return fitted_[r]; });
    for (auto& [root, part] : parts) {
      bool closed = complete;
      for (const auto& users : usersOf)
        if (!users.empty() && connected.root(users.front()) == root && users.size() != 2) closed = false;
      if (closed) part.solid = shell.solid;
      result.shells.push_back(std::move(part));
    }
  }
}

SplineModel trimModel(const Model& model, const std::vector<const GridMap*>& maps,
                      const std::vector<const FittedSurface*>& fitted, const TrimOptions& options,
                      const Progress& progress) {
  TRIMQUAD_ASSERT(maps.size() == model.regions.size() && fitted.size() == model.regions.size());
  TrimMemory ownMemory;
  const ModelTrimmer trimmer(model, maps, fitted, options, options.memory ? *options.memory : ownMemory,
                             progress);
  std::vector<double> tolerances(model.regions.size(), options.tolerance);
  constexpr int maxAttempts = 3;
  for (int attempt = 1;; ++attempt) {
    SplineModel result = trimmer.trim(tolerances);
    RegionErrorList crossings;
    std::set<int> crossed;
    for (const auto& face : result.faces)
      if (const auto crossing = loopCrossing(face)) {
        crossings.add(stageError(
            "fit", "trimming curves cross each other on the fitted surface; use a smaller tolerance",
            model.regions[face.region].name, face.surface.point((*crossing)[0], (*crossing)[1])));
        crossed.insert(face.region);
      }
    for (const int r : crossed) tolerances[r] /= 8;
    if (crossings.empty()) {
      result.moved = trimmer.movedRegions();
      return result;
    }
    if (attempt == maxAttempts) crossings.raise();
  }
}

FittedSurface fittedAsMoved(const FittedSurface& fitted, const SplineModel& model, int region) {
  const auto face = std::find_if(model.faces.begin(), model.faces.end(),
                                 [&](const SplineFace& f) { return f.region == region; });
  TRIMQUAD_ASSERT(face != model.faces.end() && model.moved.count(region) && !fitted.layout);
  FittedSurface result = fitted;
  result.surface = face->surface;
  result.deviations = {model.moved.at(region)};
  result.maxDeviation = result.deviations[0].max;
  result.rmsDeviation = result.deviations[0].rms;
  return result;
}

}  // namespace trimquad
