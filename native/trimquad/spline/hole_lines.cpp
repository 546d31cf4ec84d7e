#include "trimquad/spline/hole_lines.h"

#include <map>

namespace trimquad {
namespace {

/// A grid line that leaves the boundary; `direction` counts quarter turns along the boundary, without end.
struct Line {
  int halfedge;
  int direction;
};

struct BoundaryWalk {
  std::vector<Line> lines;
  int turned = 0;  ///< quarter turns of the lines' direction once around, clockwise negative
  bool closes = false;
};

/// Follows a boundary loop with the surface to its left, in the plane of its first piece.
class Walk {
 public:
  Walk(const CellGraph& graph, std::vector<char>& seen)
      : graph_(graph), overlay_(graph.overlay()), seen_(seen) {}

  BoundaryWalk around(int start) {
    Transition toStart;  // from the chart of the piece at hand
    int h = start;
    do {
      seen_[h] = 1;
      for (h = overlay_.halfedges[h].next; !overlay_.edges[h >> 1].border;
           h = overlay_.halfedges[h ^ 1].next) {
        if (overlay_.edges[h >> 1].grid) note(h, toStart);
        toStart = toStart.after(graph_.acrossTriangles(h));
      }
    } while (h != start);
    walk_.closes = toStart.isIdentity();
    if (!walk_.lines.empty()) {
      const int first = walk_.lines.front().direction, last = walk_.lines.back().direction;
      walk_.turned = last + turn(last, first + toStart.rotation) - first;
    }
    return std::move(walk_);
  }

 private:
  /// The least turn from one direction to another: -1, 0, 1, or 2 clockwise, for the boundary of a hole turns
  /// that way.
  static int turn(int from, int to) {
    const int quarters = ((to - from) % 4 + 4) % 4;
    return quarters < 2 ? quarters : quarters - 4;
  }

  void note(int h, const Transition& toStart) {
    const auto& half = overlay_.halfedges[h];
    const FixedVector along = rotated(overlay_.halfedges[half.next].at - half.at, toStart.rotation);
    const int direction = along.v == 0 ? (along.u > 0 ? 0 : 2) : (along.v > 0 ? 1 : 3);
    const int before = walk_.lines.empty() ? direction : walk_.lines.back().direction;
    walk_.lines.push_back({h, before + turn(before, direction)});
  }

  const CellGraph& graph_;
  const GridOverlay& overlay_;
  std::vector<char>& seen_;
  BoundaryWalk walk_;
};

}  // namespace

std::vector<int> linesFromHoles(const CellGraph& graph) {
  const auto& overlay = graph.overlay();
  std::vector<char> seen(overlay.halfedges.size(), 0);
  std::vector<int> result;
  for (int h = 0; h < int(overlay.halfedges.size()); ++h) {
    if (seen[h] || !overlay.edges[h >> 1].border || overlay.halfedges[h].piece < 0) continue;
    const BoundaryWalk walk = Walk(graph, seen).around(h);
    if (walk.closes || walk.turned >= 0) continue;
    std::map<int, std::vector<int>> byQuarter;
    for (const auto& line : walk.lines)
      byQuarter[((line.direction % walk.turned) - walk.turned) % walk.turned].push_back(line.halfedge);
    for (const auto& [quarter, lines] : byQuarter) result.push_back(lines[lines.size() / 2]);
  }
  return result;
}

}  // namespace trimquad
