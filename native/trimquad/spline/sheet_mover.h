#pragma once

#include <functional>

#include "trimquad/spline/moved_surface.h"
#include "trimquad/spline/sheet.h"
#include "trimquad/spline/trim_memory.h"

namespace trimquad {

/// Moves sheets as far as their regions allow.
class SheetMover {
 public:
  /// (sheet, new surface, as a last resort) whether it may become so
  using Accepts = std::function<bool(int, const SplineSurface&, bool)>;
  SheetMover(TrimMemory& memory, Accepts accepts, const Progress& progress)
      : memory_(memory), accepts_(std::move(accepts)), progress_(progress) {}

  const Progress& progress() const { return progress_; }
  /// Whether sheet `k` has been moved, see movedSurface().
  bool move(std::vector<Sheet>& sheets, int k, const std::vector<SurfaceMove>& moves, double fade,
            int maxPoles, bool lastResort = false) const;

 private:
  TrimMemory& memory_;
  Accepts accepts_;
  const Progress& progress_;
};

}  // namespace trimquad
