#pragma once

#include <array>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <vector>

#include "trimquad/base/disjoint_sets.h"
#include "trimquad/base/progress.h"
#include "trimquad/mesh/region.h"
#include "trimquad/spline/border_edges.h"
#include "trimquad/spline/corner_moves.h"
#include "trimquad/spline/corner_point.h"
#include "trimquad/spline/curve_pieces.h"
#include "trimquad/spline/fit_surface.h"
#include "trimquad/spline/region_errors.h"
#include "trimquad/spline/spline_model.h"
#include "trimquad/spline/tangent_sheets.h"
#include "trimquad/spline/trim_curve.h"
#include "trimquad/spline/trim_loops.h"
#include "trimquad/spline/trim_memory.h"
#include "trimquad/spline/trim_model.h"

namespace trimquad {

/// Of vertices and edges that agree with their surfaces, model units.
inline constexpr double kSmallestTolerance = 1e-7;
/// Edges between touching sheets that are further apart, by the model's diagonal, are loose.
inline constexpr double kLooseGap = 5 * kTangentGap;

/// A boundary vertex of a chart that is a corner of the model, or a place where charts meet.
struct CornerUse {
  int corner, sheet, vertex;
  std::optional<int> layoutPoint;  ///< of its region, where that is known
  Eigen::Vector3d point;
  Eigen::Vector2d guess;
  Eigen::Vector2d at;  ///< on the sheet
  int group = -1;      ///< which vertex of the result
  friend auto key(const CornerUse& use) { return std::tuple(use.corner, use.sheet, use.vertex); }
};

struct CurveWithSides {
  std::vector<SheetSide> sides;
  std::vector<SampledCurve> sampled;  ///< one for all sides where they share the edge, else one a side
  std::optional<IntersectionCurve> intersection;
  bool folded = false;  ///< whether its sheets were tangent, and have been given a slight edge there
  std::vector<TangentStretch> tangent;  ///< where they have none

  const SampledCurve& samplesOf(std::size_t side) const { return sampled[sides.size() == 2 ? 0 : side]; }
  /// Of these samples, on the side's sheet.
  const std::vector<Eigen::Vector2d>& feetOf(std::size_t side) const {
    return samplesOf(side).foot[sides.size() == 2 ? side : 0];
  }
};

/// Trims fitted surfaces and joins them. Everything that does not depend on how closely free edges follow
/// their curves is settled once, in the constructor.
class ModelTrimmer {
 public:
  ModelTrimmer(const Model& model, const std::vector<const GridMap*>& maps,
               const std::vector<const FittedSurface*>& fitted, const TrimOptions& options,
               TrimMemory& memory, const Progress& progress)
      : model_(model),
        maps_(maps),
        fitted_(fitted),
        tolerance_(options.tolerance),
        enough_(std::max(options.enough, options.tolerance)),
        reach_(10 * tolerance_ + 1e-9 * model.diagonal),
        memory_(memory),
        threads_(options.threads),
        progress_(progress) {
    memory_.startTrim();
    makeSheets();
    collectRuns();
    meetInCorners();
    numberSheets();
    forEachCurve([&](int id, CurveWithSides& curve) { sample(id, curve); });
    settleRunEnds();
    placeSeams();
    numberSheets();
    forEachCurve([&](int, CurveWithSides& curve) { intersect(curve); });
    joinTangent();
    placeCorners();
  }

  /// \param tolerances by region: how far free edges may be from their curves, model units
  SplineModel trim(const std::vector<double>& tolerances) const;
  /// The surfaces of the regions that were moved, and how far these are from them now, by chart.
  std::map<int, std::vector<SplineModel::MovedSurface>> movedRegions() const;

 private:
  void makeSheets();
  void numberSheets();
  void collectRuns();
  void settleSplits(std::vector<CurveSplit>& splits);
  int sheetOf(const BoundaryRun& run) const { return firstSheet_[run.region] + run.chart; }

  /// Calls `step(id, curve)` for all curves, several at once. Throws what goes wrong together.
  template <class Step>
  void forEachCurve(const Step& step) {
    std::vector<std::pair<int, CurveWithSides*>> all;
    for (auto& [id, curve] : curves_) all.push_back({id, &curve});
    RegionErrorList errors;
    errors.attemptEach(int(all.size()), threads_, [&](int k) { step(all[k].first, *all[k].second); });
    errors.raise();
  }
  void sample(int id, CurveWithSides& curve) const;
  void settleRunEnds();
  void intersect(CurveWithSides& curve) const;
  ByteKey keyOf(const SampledCurve& sampled, const std::vector<SheetSide>& sides) const;
  long numberOfRegion(int r) const;
  std::vector<SheetCorner> tangentCorners() const;
  template <class Samples>
  ChartDeviation measured(int r, const SplineSurface& surface, ByteKey key, const Samples& samples) const;
  template <class Make>
  auto keptSamples(int r, const ByteKey& key, const Make& make) const;
  ChartDeviation deviationOf(int r, const SplineSurface& surface) const;
  ChartDeviation deviationOfChart(int r, int chart, const SplineSurface& surface) const;
  ChartDeviation deviationOfSheet(int sheet, const SplineSurface& surface) const;
  bool acceptsMoved(const std::map<int, SplineSurface>& surfaces, bool lastResort) const;
  std::vector<SheetBody> bodies() const;
  SheetMover mover() const;
  void meetInCorners();
  void joinTangent();
  std::vector<int> joinTangent(const std::map<int, double>& gaps, const std::set<int>& corners);

  void placeSeams() {
    for (int k = 0; k < int(sheets_.size()); ++k) {
      if (!sheets_[k].period) continue;
      std::vector<std::vector<Eigen::Vector2d>> boundary;
      for (const auto& [id, curve] : curves_)
        for (std::size_t side = 0; side < curve.sides.size(); ++side)
          if (sheetOf(*curve.sides[side].run) == k) boundary.push_back(curve.feetOf(side));
      sheets_[k].surface = withSeamAt(sheets_[k].surface, seamPlace(sheets_[k], boundary));
    }
  }

  int cornerUse(const BoundaryRun& run, const RunEnd& end) const {
    const CornerUse wanted{cornerOf(end), sheetOf(run), end.vertex, {}, {}, {}, {}};
    const auto found =
        std::lower_bound(uses_.begin(), uses_.end(), wanted,
                         [](const CornerUse& x, const CornerUse& y) { return key(x) < key(y); });
    return int(found - uses_.begin());
  }
  int cornerOf(const RunEnd& end) const { return corners_[end.corner]; }
  /// \param otherwise for corners that are not the model's
  Eigen::Vector3d pointOfCorner(int corner, const Eigen::Vector3d& otherwise) const {
    return corner < int(model_.corners.size()) ? model_.corners[corner] : otherwise;
  }
  int groupOf(const BoundaryRun& run, const RunEnd& end) const { return uses_[cornerUse(run, end)].group; }

  void placeCorners();
  CornerPoint cornerOnBorders(const std::vector<int>& members);
  void placeInnerPoints();
  int layoutPoint(const CornerUse& use) const;
  std::optional<Eigen::Vector2d> borderEnd(const BoundaryRun& run, const RunEnd& end) const;
  bool endsFold(int corner) const;

  struct CurveEdge {
    std::vector<TrimPiece> pieces;
    std::vector<const SheetSide*> sides;
    bool strays = false;  ///< leaves part of the curve beyond both sheets, farther away than is enough
  };
  std::vector<CurveEdge> edgesOf(int id, const CurveWithSides& curve,
                                 const std::vector<double>& tolerances) const;
  std::vector<TrimPiece> looseEdgeOf(const CurveWithSides& curve,
                                     const std::vector<double>& tolerances) const;
  bool strays(const CurveWithSides& curve, const std::vector<TrimPiece>& edge) const;
  std::vector<TrimPiece> freeEdgeOf(int id, const SampledCurve& sampled, const SheetSide& side,
                                    double tolerance) const;
  PieceLoop borderPiece(int region, const Layout::Stretch& stretch,
                        const std::vector<SplineEdgeId>& edges) const;
  void appendShells(SplineModel& result) const;

  const Model& model_;
  const std::vector<const GridMap*>& maps_;
  const std::vector<const FittedSurface*>& fitted_;
  double tolerance_, enough_, reach_;
  TrimMemory& memory_;
  int threads_;
  const Progress& progress_;
  std::vector<int> corners_;  ///< by corner: the one that stands for all that short curves connect
  std::vector<Sheet> sheets_;
  std::vector<long> sheetNumbers_;                   ///< of their surfaces, in keys of the memory
  std::vector<int> sheetRegion_, firstSheet_;        ///< by sheet; by region
  std::vector<std::optional<BorderLines>> borders_;  ///< by region, where it has several charts
  std::vector<BoundaryRun> runs_;                    ///< region by region, in the order of their loops
  std::optional<CurvePieces> curvePieces_;
  std::map<int, CurveWithSides> curves_;                     ///< by piece
  std::vector<CornerUse> uses_;                              ///< ascending
  std::vector<CornerPoint> vertices_;                        ///< by group
  std::map<std::pair<int, int>, int> vertexOfPoint_;         ///< by region and point of its layout: group
  std::vector<std::vector<BorderLines::Edge>> borderEdges_;  ///< by region
  std::set<int> moved_;                                      ///< regions whose surfaces were moved
};

}  // namespace trimquad
