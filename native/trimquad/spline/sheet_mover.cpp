#include "trimquad/spline/sheet_mover.h"

namespace trimquad {
bool SheetMover::move(std::vector<Sheet>& sheets, int k, const std::vector<SurfaceMove>& moves, double fade,
                      int maxPoles, bool lastResort) const {
  progress_.check();
  const SplineSurface& before = sheets[k].surface;
  ByteKey key;
  addTo(key, before).add(fade).add(maxPoles);
  for (const auto& move : moves)
    key.add(move.at).add(move.by).add(move.along).add(move.weight).add(move.error).add(move.firm);
  auto surface = memory_.recall<std::optional<SplineSurface>>(
      "move", std::move(key), [&] { return movedSurface(before, moves, fade, maxPoles, progress_); });
  if (!surface || !accepts_(k, *surface, lastResort)) return false;
  sheets[k].surface = std::move(*surface);
  return true;
}

}  // namespace trimquad
