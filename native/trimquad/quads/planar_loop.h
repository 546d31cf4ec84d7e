#pragma once

#include <array>
#include <vector>

#include "trimquad/base/fixed.h"

namespace trimquad {

struct PlanarCorner {
  int point;           ///< corners are the same when their points are
  FixedVector at;      ///< position in the plane
  bool inner = false;  ///< other polygons meet all around it: diagonals rather end elsewhere
};

/// A closed polygon with its inside to the left.
using PlanarLoop = std::vector<PlanarCorner>;

WideQuanta doubleArea(const PlanarLoop& loop);

inline WideQuanta squaredDistance(const PlanarCorner& p, const PlanarCorner& q) {
  return dot(q.at - p.at, q.at - p.at);
}

/// Whether the segments p -> q and r -> s meet other than in ends that are the same corner. Exact.
bool meet(const PlanarCorner& p, const PlanarCorner& q, const PlanarCorner& r, const PlanarCorner& s);

/// How many of the loops' sides the segment p -> q meets other than in its own ends. Exact.
int crossings(const std::vector<PlanarLoop>& loops, const PlanarCorner& p, const PlanarCorner& q);

/// Whether the direction from corner i of the loop to `x` leads into the loop's inside. Exact.
bool leadsInside(const PlanarLoop& loop, std::size_t i, FixedVector x);

/// Of the corner that is the point; the loop's size if none is.
std::size_t positionIn(const PlanarLoop& loop, int point);

/// Whether x lies inside; on a side of the loop either. Exact.
bool isInside(const PlanarLoop& loop, FixedVector x);

/// The corners from one position of the loop on to another, both included.
PlanarLoop stretch(const PlanarLoop& loop, std::size_t from, std::size_t to);

/// The loop with the corners of `way` between two consecutive ones. Its ends may repeat these.
PlanarLoop withWay(const PlanarLoop& loop, const PlanarCorner& from, const PlanarCorner& to,
                   const PlanarLoop& way);

/// A side that a loop, or two loops, run along in both directions: between two of its own parts.
using Spur = std::array<PlanarCorner, 2>;

/// Simple loops that are joined by common points, or by spurs.
struct SimpleLoops {
  std::vector<PlanarLoop> loops;  ///< the outer one first, as far as areas tell
  std::vector<Spur> spurs;
};

/// Divides loops along their spurs, and where they come through a point twice.
SimpleLoops dividedWherePinched(const std::vector<PlanarLoop>& loops);
/// The way back: loops with a common point, or with the two ends of a spur, become one that comes through
/// these twice. Spurs with both ends in one loop divide it; `apart` gets the parts beyond them.
std::vector<PlanarLoop> joinedWherePinched(SimpleLoops simple, std::vector<PlanarLoop>& apart);

}  // namespace trimquad
