#include "trimquad/spline/trim_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "trimquad/base/error.h"
#include "trimquad/spline/model_trimmer.h"
#include "trimquad/spline/tangent_sheets.h"

namespace trimquad {
namespace {

constexpr double kSheetSlack = 0.5;  ///< quads
/// Shorter curves vanish: their ends become one vertex.
constexpr double kShortestEdge = 10 * kSmallestTolerance;
/// A loop along a grid line lies on it up to rounding.
constexpr double kOnLine = 1e-9;  ///< quads

/// The first knot of the span that holds `low` and the last one of that which holds `high`.
std::array<double, 2> spansAround(const std::vector<double>& knots, int degree, double low, double high) {
  return {knots[knotSpan(knots, degree, low + kOnLine)], knots[knotSpan(knots, degree, high - kOnLine) + 1]};
}

/// Takes away what of the surface lies beyond all loops, by whole knot spans: there it may lie on others, and
/// programs that intersect surfaces take them whole.
void leaveOutWhatIsUnused(SplineFace& face) {
  Eigen::AlignedBox2d box;
  for (const auto& coedge : face.loops.front())
    for (const auto& pole : coedge.curve.poles) box.extend(pole);
  SplineSurface& s = face.surface;
  const auto u = s.closedU ? std::array{s.firstU(), s.lastU()}
                           : spansAround(s.knotsU, s.degreeU, box.min()[0], box.max()[0]);
  const auto v = spansAround(s.knotsV, s.degreeV, box.min()[1], box.max()[1]);
  s = restricted(s, Eigen::AlignedBox2d(Eigen::Vector2d(u[0], v[0]), Eigen::Vector2d(u[1], v[1])));
}

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
  for (const auto& sheet : sheets_) {
    ByteKey key;
    addTo(key, sheet.surface).add(sheet.period.value_or(0)).add(sheet.slack);
    sheetNumbers_.push_back(memory_.numberOf("sheet", std::move(key)));
  }
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

PieceLoop ModelTrimmer::borderPiece(int region, const Layout::Stretch& stretch,
                                    const std::vector<SplineEdgeId>& edges) const {
  const auto& edge = borderEdges_[region][*stretch.border];
  const bool forward = stretch.forward != edge.reversed;
  return {{{edges[*stretch.border], forward, edge.onSheet[stretch.forward ? 0 : 1]},
           forward ? edge.edge.start : edge.edge.end,
           forward ? edge.edge.end : edge.edge.start}};
}

SplineModel ModelTrimmer::trim(const std::vector<double>& tolerances) const {
  SplineModel result;
  for (const auto& vertex : vertices_) result.vertices.push_back({vertex.point, kSmallestTolerance});
  std::map<const BoundaryRun*, std::vector<LoopPiece>> pieces;
  const auto addEdge = [&](const CurveEdge& added) {
    const auto& [edge, sides, strays] = added;
    if (strays)
      for (const auto* side : sides) result.strayRegions.insert(side->run->region);
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
      if (sides.size() == 2 && edge[i].gap > kLooseGap * model_.diagonal) {
        ++result.looseEdges;
        for (const auto* side : sides) result.looseRegions.insert(side->run->region);
      }
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
  std::map<int, int> bodyOfSolid;
  for (int s = 0; s < int(model_.shells.size()); ++s) {
    const auto& shell = model_.shells[s];
    const int body = shell.solid ? bodyOfSolid.try_emplace(*shell.solid, s).first->second : s;
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
      part.body = body;
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
      for (auto& face : result.faces) leaveOutWhatIsUnused(face);
      result.moved = trimmer.movedRegions();
      return result;
    }
    if (attempt == maxAttempts) crossings.raise();
  }
}

FittedSurface fittedAsMoved(const FittedSurface& fitted, const SplineModel& model, int region) {
  FittedSurface result = fitted;
  const auto& moved = model.moved.at(region);
  result.deviations.resize(moved.size());
  result.maxDeviation = 0;
  for (std::size_t c = 0; c < moved.size(); ++c) {
    (fitted.layout ? result.surfaces[c] : result.surface) = moved[c].surface;
    const bool same = fitted.layout && moved[c].surface.poles == fitted.surfaces[c].poles;
    result.deviations[c] = same ? fitted.deviations[c] : moved[c].deviation;
    result.maxDeviation = std::max(result.maxDeviation, result.deviations[c].max);
  }
  if (!fitted.layout) result.rmsDeviation = result.deviations[0].rms;
  return result;
}

}  // namespace trimquad
