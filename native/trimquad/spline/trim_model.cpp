#include "trimquad/spline/trim_model.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "trimquad/base/disjoint_sets.h"
#include "trimquad/base/error.h"
#include "trimquad/spline/corner_point.h"
#include "trimquad/spline/trim_curve.h"
#include "trimquad/spline/trim_loops.h"

namespace trimquad {
namespace {

constexpr double kSmallestTolerance = 1e-7;
/// Shorter curves vanish: their ends become one vertex.
constexpr double kShortestEdge = 10 * kSmallestTolerance;

/// A boundary vertex of a region that is a corner of the model.
struct CornerUse {
  int corner, region;
  VertexHandle vertex;
  Eigen::Vector2d guess;
  Eigen::Vector2d at;  ///< on the region's sheet
  int group = -1;      ///< which vertex of the result
  friend auto key(const CornerUse& use) { return std::tuple(use.corner, use.region, use.vertex.idx()); }
};

struct CurveWithSides {
  std::vector<SheetSide> sides;
  std::vector<SampledCurve> sampled;  ///< one for all sides where they share the edge, else one a side
  std::optional<IntersectionCurve> intersection;
};

/// Everything that does not depend on how closely free edges follow their curves is settled once, in the
/// constructor.
class ModelTrimmer {
 public:
  ModelTrimmer(const Model& model, const std::vector<const FittedSurface*>& fitted, double tolerance,
               const Progress& progress)
      : model_(model),
        fitted_(fitted),
        tolerance_(tolerance),
        reach_(10 * tolerance + 1e-9 * model.diagonal),
        progress_(progress),
        corners_(model.corners.size()) {
    makeSheets();
    collectRuns();
    sampleCurves();
    placeSeams();
    for (auto& [id, curve] : curves_)
      if (curve.sides.size() == 2)
        curve.intersection =
            intersectionCurve(curve.sampled.front(), curve.sides, tolerance_, reach_, progress_);
    placeCorners();
  }

  /// \param closeness by region: how far free edges may be from their curves as seen on the sheet, model
  /// units
  SplineModel trim(const std::vector<double>& closeness) const;

 private:
  void makeSheets() {
    for (const FittedSurface* fit : fitted_) {
      auto& sheet = sheets_.emplace_back();
      if (!fit) continue;
      sheet.surface = fit->surface;
      if (fit->surface.closedU) sheet.period = fit->surface.lastU() - fit->surface.firstU();
    }
  }

  void collectRuns() {
    for (int r = 0; r < int(model_.regions.size()); ++r) {
      auto& runs = runs_.emplace_back();
      if (fitted_[r]) runs = boundaryRuns(model_, r, fitted_[r]->chart);
    }
    const auto tooShort = [&](const BoundaryRun& run) {
      double length = 0;
      for (std::size_t i = 0; i + 1 < run.vertices.size(); ++i)
        length += (model_.regions[run.region].mesh.point(run.vertices[i]) -
                   model_.regions[run.region].mesh.point(run.vertices[i + 1]))
                      .norm();
      return length < kShortestEdge;
    };
    for (auto& runs : runs_) {
      for (const auto& run : runs)
        if (tooShort(run))
          corners_.unite(model_.curves[run.curve.index].start.index,
                         model_.curves[run.curve.index].end.index);
      std::erase_if(runs, tooShort);
    }
    for (const auto& runs : runs_)
      for (const auto& run : runs)
        curves_[run.curve.index].sides.push_back(
            {&sheets_[run.region], &run, model_.regions[run.region].name, {}, {}});
  }

  void sampleCurves() {
    // A sheet lies within the tolerance of its region; twenty times as much is another place of it.
    const double reach = 20 * tolerance_ + 1e-9 * model_.diagonal;
    for (auto& [id, curve] : curves_) {
      progress_.check();
      if (curve.sides.size() == 2)
        curve.sampled.push_back(sampleCurve(model_.curves[id], curve.sides, reach));
      else
        for (const auto& side : curve.sides)
          curve.sampled.push_back(sampleCurve(model_.curves[id], {side}, reach));
    }
  }

  void placeSeams() {
    for (int r = 0; r < int(sheets_.size()); ++r) {
      if (!sheets_[r].period) continue;
      std::vector<std::vector<Eigen::Vector2d>> boundary;
      for (const auto& [id, curve] : curves_)
        for (std::size_t k = 0; k < curve.sides.size(); ++k)
          if (curve.sides[k].run->region == r)
            boundary.push_back(curve.sides.size() == 2 ? curve.sampled[0].foot[k] : curve.sampled[k].foot[0]);
      sheets_[r].surface = withSeamAt(sheets_[r].surface, seamPlace(sheets_[r], boundary));
    }
  }

  int cornerUse(int region, VertexHandle v) const {
    const CornerUse wanted{cornerOf(region, v), region, v, {}, {}};
    const auto found =
        std::lower_bound(uses_.begin(), uses_.end(), wanted,
                         [](const CornerUse& x, const CornerUse& y) { return key(x) < key(y); });
    return int(found - uses_.begin());
  }
  int cornerOf(int region, VertexHandle v) const {
    return const_cast<DisjointSets&>(corners_).root(model_.regions[region].corner[v.idx()]->index);
  }

  void placeCorners();

  void appendShells(SplineModel& result) const;

  const Model& model_;
  const std::vector<const FittedSurface*>& fitted_;
  double tolerance_, reach_;
  const Progress& progress_;
  DisjointSets corners_;
  std::vector<Sheet> sheets_;
  std::vector<std::vector<BoundaryRun>> runs_;
  std::map<int, CurveWithSides> curves_;  ///< by CurveId
  std::vector<CornerUse> uses_;           ///< ascending
  std::vector<CornerPoint> vertices_;     ///< by group
};

void ModelTrimmer::placeCorners() {
  for (const auto& runs : runs_)
    for (const auto& run : runs) {
      uses_.push_back(
          {cornerOf(run.region, run.vertices.front()), run.region, run.vertices.front(), run.uv.front(), {}});
      uses_.push_back(
          {cornerOf(run.region, run.vertices.back()), run.region, run.vertices.back(), run.uv.back(), {}});
    }
  std::sort(uses_.begin(), uses_.end(),
            [](const CornerUse& x, const CornerUse& y) { return key(x) < key(y); });
  uses_.erase(std::unique(uses_.begin(), uses_.end(),
                          [](const CornerUse& x, const CornerUse& y) { return key(x) == key(y); }),
              uses_.end());

  // What meets in one corner is one vertex where a shared curve or a shell holds it together.
  DisjointSets together(uses_.size());
  for (const auto& [id, curve] : curves_)
    if (curve.sides.size() == 2) {
      const auto &a = *curve.sides[0].run, &b = *curve.sides[1].run;
      together.unite(cornerUse(a.region, a.vertices.front()), cornerUse(b.region, b.vertices.front()));
      together.unite(cornerUse(a.region, a.vertices.back()), cornerUse(b.region, b.vertices.back()));
    }
  std::vector<int> shellOf(model_.regions.size(), -1);
  for (int s = 0; s < int(model_.shells.size()); ++s)
    for (const int r : model_.shells[s].regions) shellOf[r] = s;
  for (std::size_t i = 0; i < uses_.size(); ++i)
    for (std::size_t j = i + 1; j < uses_.size() && uses_[j].corner == uses_[i].corner; ++j)
      if (shellOf[uses_[i].region] == shellOf[uses_[j].region]) together.unite(int(i), int(j));

  std::map<int, std::vector<int>> groups;
  for (int i = 0; i < int(uses_.size()); ++i) groups[together.root(i)].push_back(i);
  for (const auto& [first, members] : groups) {
    std::vector<const Sheet*> sheets;
    std::vector<Eigen::Vector2d> guess;
    for (const int i : members) {
      sheets.push_back(&sheets_[uses_[i].region]);
      guess.push_back(uses_[i].guess);
    }
    const auto& mesh = model_.regions[uses_[first].region].mesh;
    vertices_.push_back(cornerPoint(mesh.point(uses_[first].vertex), sheets, guess, reach_));
    for (std::size_t k = 0; k < members.size(); ++k) {
      uses_[members[k]].group = int(vertices_.size()) - 1;
      uses_[members[k]].at = vertices_.back().at[k];
    }
  }
  for (auto& [id, curve] : curves_)
    for (auto& side : curve.sides) {
      const auto unwrapped = [&](VertexHandle v, const Eigen::Vector2d& near) {
        Eigen::Vector2d x = uses_[cornerUse(side.run->region, v)].at;
        if (const auto& period = side.sheet->period) x[0] += *period * std::round((near[0] - x[0]) / *period);
        return x;
      };
      side.start = unwrapped(side.run->vertices.front(), side.run->uv.front());
      side.end = unwrapped(side.run->vertices.back(), side.run->uv.back());
    }
}

SplineModel ModelTrimmer::trim(const std::vector<double>& closeness) const {
  SplineModel result;
  for (const auto& vertex : vertices_) result.vertices.push_back({vertex.point, kSmallestTolerance});
  std::map<const BoundaryRun*, std::vector<LoopPiece>> pieces;
  const auto addEdges = [&](const std::vector<TrimPiece>& edge, const std::vector<const SheetSide*>& sides) {
    const auto group = [&](VertexHandle v) {
      return SplineVertexId{uses_[cornerUse(sides[0]->run->region, v)].group};
    };
    SplineVertexId start = group(sides[0]->run->vertices.front());
    for (std::size_t i = 0; i < edge.size(); ++i) {
      SplineVertexId end = group(sides[0]->run->vertices.back());
      if (i + 1 < edge.size()) {
        end = {int(result.vertices.size())};
        result.vertices.push_back({edge[i].curve.poles.back(), kSmallestTolerance});
      }
      const SplineEdgeId id{int(result.edges.size())};
      result.edges.push_back({edge[i].curve, start, end, std::max(kSmallestTolerance, 1.01 * edge[i].gap)});
      for (std::size_t k = 0; k < sides.size(); ++k) {
        const bool forward = sides[k]->run->forward;
        pieces[sides[k]->run].push_back(
            {{id, forward, edge[i].onSheet[k]}, forward ? start : end, forward ? end : start});
      }
      start = end;
    }
  };
  for (const auto& [id, curve] : curves_) {
    progress_.check();
    if (curve.sides.size() == 2) {
      const SheetSide &a = curve.sides[0], &b = curve.sides[1];
      std::optional<std::vector<TrimPiece>> edge;
      if (curve.intersection) {
        const auto vertexPoint = [&](VertexHandle v) {
          return vertices_[uses_[cornerUse(a.run->region, v)].group].point;
        };
        edge =
            sharedEdge(*curve.intersection, model_.curves[id].start == model_.curves[id].end,
                       vertexPoint(a.run->vertices.front()), vertexPoint(a.run->vertices.back()), progress_);
      }
      if (!edge) {
        const double near = std::min(closeness[a.run->region], closeness[b.run->region]);
        edge = looseEdge(curve.sampled.front(), curve.sides, near, progress_);
        result.looseEdges += int(edge->size());
      }
      addEdges(*edge, {&a, &b});
    } else {
      for (std::size_t k = 0; k < curve.sides.size(); ++k)
        addEdges(freeEdge(curve.sampled[k], curve.sides[k], closeness[curve.sides[k].run->region], progress_),
                 {&curve.sides[k]});
    }
  }

  for (int r = 0; r < int(runs_.size()); ++r) {
    if (!fitted_[r]) continue;
    std::map<int, PieceLoop> loops;
    for (const auto& run : runs_[r]) {
      auto& part = pieces.at(&run);
      if (!run.forward) std::reverse(part.begin(), part.end());
      auto& loop = loops[run.loop];
      loop.insert(loop.end(), part.begin(), part.end());
    }
    std::vector<PieceLoop> inOrder;
    for (auto& [index, loop] : loops) inOrder.push_back(std::move(loop));
    for (auto& face : trimmedFaces(sheets_[r], inOrder, r, model_.regions[r].name, result))
      result.faces.push_back(std::move(face));
  }

  for (const auto& face : result.faces)
    for (const auto& loop : face.loops)
      for (const auto& coedge : loop) {
        const SplineEdge& edge = result.edges[coedge.edge.index];
        const Sheet sheet{face.surface, {}};
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

}  // namespace

SplineModel trimModel(const Model& model, const std::vector<const GridMap*>& maps,
                      const std::vector<const FittedSurface*>& fitted, double tolerance,
                      const Progress& progress) {
  TRIMQUAD_ASSERT(maps.size() == model.regions.size() && fitted.size() == model.regions.size());
  const ModelTrimmer trimmer(model, fitted, tolerance, progress);
  std::vector<double> closeness(model.regions.size(), tolerance / 4);
  constexpr int maxAttempts = 3;
  for (int attempt = 1;; ++attempt) {
    SplineModel result = trimmer.trim(closeness);
    bool clean = true;
    for (const auto& face : result.faces) {
      const auto crossing = loopCrossing(face);
      if (!crossing) continue;
      clean = false;
      if (attempt == maxAttempts)
        throw stageError("fit",
                         "trimming curves cross each other on the fitted surface; use a smaller tolerance",
                         model.regions[face.region].name, face.surface.point((*crossing)[0], (*crossing)[1]));
      closeness[face.region] /= 8;
    }
    if (clean) return result;
  }
}

}  // namespace trimquad
