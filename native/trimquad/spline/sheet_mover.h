#pragma once

#include <functional>
#include <map>
#include <vector>

#include "trimquad/spline/moved_surface.h"
#include "trimquad/spline/sheet.h"
#include "trimquad/spline/trim_memory.h"

namespace trimquad {

/// Sheets that move together: those of one region, in the order of its charts.
struct SheetBody {
  int first = 0, count = 1;
  const Layout* layout = nullptr;      ///< where they are those of a region's charts
  const JoinedKnots* knots = nullptr;  ///< by which these are joined; without they cannot move

  bool isSingle() const { return !layout; }
  bool mayMove() const { return isSingle() || knots; }
};

/// By sheet.
using SheetMoves = std::map<int, std::vector<SurfaceMove>>;

/// Moves sheets as far as their regions allow.
class SheetMover {
 public:
  /// (body, its sheets' new surfaces by sheet, as a last resort) whether they may become so
  using Accepts = std::function<bool(int, const std::map<int, SplineSurface>&, bool)>;
  /// \param bodies of all sheets, in their order
  SheetMover(std::vector<SheetBody> bodies, TrimMemory& memory, Accepts accepts, const Progress& progress);

  const std::vector<SheetBody>& bodies() const { return bodies_; }
  int bodyOf(int sheet) const { return bodyOf_[sheet]; }
  const SheetBody& ofSheet(int sheet) const { return bodies_[bodyOf_[sheet]]; }
  const Progress& progress() const { return progress_; }
  /// The poles of those sheets of a body that move where these have moves.
  int poles(const std::vector<Sheet>& sheets, int body, const SheetMoves& moves) const;
  /// Whether a body's sheets have been moved, see movedSurface().
  bool move(std::vector<Sheet>& sheets, int body, const SheetMoves& moves, double fade, int maxPoles,
            bool lastResort = false) const;

 private:
  std::vector<SheetBody> bodies_;
  std::vector<int> bodyOf_;
  TrimMemory& memory_;
  Accepts accepts_;
  const Progress& progress_;
};

}  // namespace trimquad
