#include "trimquad/spline/sheet_mover.h"

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

SheetMoves byChart(const SheetBody& body, const SheetMoves& moves) {
  SheetMoves result;
  for (const auto& [sheet, ofSheet] : moves) result[sheet - body.first] = ofSheet;
  return result;
}

}  // namespace

SheetMover::SheetMover(std::vector<SheetBody> bodies, TrimMemory& memory, Accepts accepts,
                       const Progress& progress)
    : bodies_(std::move(bodies)), memory_(memory), accepts_(std::move(accepts)), progress_(progress) {
  for (int b = 0; b < int(bodies_.size()); ++b) bodyOf_.insert(bodyOf_.end(), bodies_[b].count, b);
}

int SheetMover::poles(const std::vector<Sheet>& sheets, int body, const SheetMoves& moves) const {
  const SheetBody& b = bodies_[body];
  if (b.isSingle()) return int(sheets[b.first].surface.poles.size());
  int sum = 0;
  for (const int c : movingCharts(*b.layout, byChart(b, moves)))
    sum += int(sheets[b.first + c].surface.poles.size());
  return sum;
}

bool SheetMover::move(std::vector<Sheet>& sheets, int body, const SheetMoves& moves, double fade,
                      int maxPoles, bool lastResort) const {
  progress_.check();
  const SheetBody& b = bodies_[body];
  TRIMQUAD_ASSERT(b.mayMove() && !moves.empty());
  ByteKey key;
  key.add(fade).add(maxPoles);
  std::vector<const SplineSurface*> before;
  for (int k = b.first; k < b.first + b.count; ++k) {
    before.push_back(&sheets[k].surface);
    addTo(key, *before.back());
  }
  if (b.knots)
    for (const auto& [end, gluing] : b.knots->gluing)
      key.add(end.first).add(end.second).add(gluing.left).add(gluing.right).add(gluing.along);
  const SheetMoves ofCharts = byChart(b, moves);
  for (const auto& [chart, ofChart] : ofCharts) {
    key.add(chart);
    for (const auto& move : ofChart)
      key.add(move.at).add(move.by).add(move.along).add(move.weight).add(move.error).add(move.firm);
  }
  using Surfaces = std::optional<std::map<int, SplineSurface>>;
  const auto surfaces = memory_.recall<Surfaces>("move", std::move(key), [&]() -> Surfaces {
    if (!b.isSingle()) return movedSurfaces(before, *b.layout, *b.knots, ofCharts, fade, maxPoles, progress_);
    auto surface = movedSurface(*before[0], ofCharts.at(0), fade, maxPoles, progress_);
    if (!surface) return {};
    return std::map<int, SplineSurface>{{0, std::move(*surface)}};
  });
  if (!surfaces) return false;
  std::map<int, SplineSurface> bySheet;
  for (const auto& [chart, surface] : *surfaces) bySheet[b.first + chart] = surface;
  if (!accepts_(body, bySheet, lastResort)) return false;
  for (auto& [sheet, surface] : bySheet) sheets[sheet].surface = std::move(surface);
  return true;
}

}  // namespace trimquad
