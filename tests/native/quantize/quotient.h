#pragma once

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "trimquad/base/disjoint_sets.h"
#include "trimquad/quantize/dual.h"

namespace trimquad {

/// The quad layout that lengths describe, built without looking for collapses: patches with an area are glued
/// along the unit pieces of their sides; zero patches identify what lies opposite, zero arcs their ends. The
/// lengths are valid if and only if that is the same surface again, with every critical node on a vertex of
/// its own.
class QuotientSurface {
 public:
  QuotientSurface(const TMesh& tmesh, const ArcLengths& q)
      : tmesh_(tmesh), q_(q), pointSets_(0), pieceSets_(0) {
    int points = int(tmesh.nodes.size()), pieces = 0;
    for (std::size_t a = 0; a < q.size(); ++a) {
      firstPoint_.push_back(points), firstPiece_.push_back(pieces);
      points += std::max(0, q[a] - 1), pieces += q[a];
    }
    pointSets_ = DisjointSets(std::size_t(points)), pieceSets_ = DisjointSets(std::size_t(pieces));
    for (std::size_t a = 0; a < q.size(); ++a)
      if (q[a] == 0) pointSets_.unite(tmesh.arcs[a].from.index, tmesh.arcs[a].to.index);
    for (const auto& patch : tmesh.patches)
      for (int axis = 0; axis < 2; ++axis) {
        if (lengthOf(patch.sides[1 - axis], q) > 0) continue;
        const auto near = walk(patch.sides[axis]), far = walk(patch.sides[axis + 2]);
        const std::size_t n = near.pieces.size();
        for (std::size_t k = 0; k <= n; ++k) pointSets_.unite(near.points[k], far.points[n - k]);
        for (std::size_t k = 0; k < n; ++k) pieceSets_.unite(near.pieces[k], far.pieces[n - 1 - k]);
      }
  }

  /// \param aligned whether aligned curves count as well: no two pieces of them coincide
  bool isSound(int eulerCharacteristic, int boundaryLoops) {
    std::map<int, std::vector<std::array<int, 2>>> uses;  // by piece: its ends, once for each patch beside it
    std::map<int, std::vector<std::array<int, 2>>> corners;  // by point: the pieces before and after it
    int faces = 0;
    for (const auto& patch : tmesh_.patches) {
      if (lengthOf(patch.sides[0], q_) == 0 || lengthOf(patch.sides[1], q_) == 0) continue;
      ++faces;
      std::vector<int> points, pieces;
      for (const auto& side : patch.sides) {
        const auto w = walk(side);
        points.insert(points.end(), w.points.begin(), w.points.end() - 1);
        pieces.insert(pieces.end(), w.pieces.begin(), w.pieces.end());
      }
      const std::size_t n = pieces.size();
      for (std::size_t k = 0; k < n; ++k) {
        const int piece = pieceSets_.root(pieces[k]);
        uses[piece].push_back({pointSets_.root(points[k]), pointSets_.root(points[(k + 1) % n])});
        corners[pointSets_.root(points[k])].push_back({pieceSets_.root(pieces[(k + n - 1) % n]), piece});
      }
    }
    std::map<int, int> borderPieces, curvePieces;
    std::set<int> borderPoints;
    for (std::size_t a = 0; a < q_.size(); ++a) {
      const auto& arc = tmesh_.arcs[a];
      for (int k = 0; k < q_[a]; ++k) {
        const int piece = pieceSets_.root(firstPiece_[a] + k);
        if (!uses.count(piece)) return false;  // a part of the surface has no area
        borderPieces[piece] += arc.border;
        curvePieces[piece] += arc.border || arc.critical;
      }
      if (arc.border)
        for (const int p : walk({HalfArc{ArcId{int(a)}, true}}).points)
          borderPoints.insert(pointSets_.root(p));
    }
    std::map<int, std::vector<int>> borderNext;
    for (const auto& [piece, ends] : uses) {
      if (int(ends.size()) + borderPieces[piece] != 2 || curvePieces[piece] > 1) return false;
      if (ends.size() == 1) borderNext[ends[0][0]].push_back(ends[0][1]);
    }
    std::map<int, std::vector<int>> nodes;
    for (std::size_t n = 0; n < tmesh_.nodes.size(); ++n) nodes[pointSets_.root(int(n))].push_back(int(n));
    for (const auto& [point, members] : nodes) {
      int critical = 0;
      for (const int n : members) {
        critical += tmesh_.nodes[n].critical;
        if (tmesh_.nodes[n].critical && !tmesh_.nodes[n].border && borderPoints.count(point)) return false;
      }
      if (critical > 1 || !corners.count(point)) return false;
    }
    for (const auto& [point, around] : corners)
      if (!isFan(around)) return false;
    // One loop per boundary loop: every border point has one piece before and one after it.
    std::set<int> reached;
    int loops = 0;
    for (const auto& [start, next] : borderNext) {
      if (next.size() != 1) return false;
      if (reached.count(start)) continue;
      ++loops;
      for (int p = start; reached.insert(p).second;) p = borderNext[p].empty() ? p : borderNext[p].front();
    }
    return loops == boundaryLoops && int(corners.size()) - int(uses.size()) + faces == eulerCharacteristic;
  }

 private:
  struct Walk {
    std::vector<int> points, pieces;
  };

  Walk walk(const TMesh::Side& side) const {
    Walk w;
    w.points.push_back(tmesh_.start(side.front()).index);
    for (const HalfArc h : side) {
      const int a = h.arc.index, length = q_[a];
      for (int k = 0; k < length; ++k) w.pieces.push_back(firstPiece_[a] + (h.forward ? k : length - 1 - k));
      for (int k = 1; k < length; ++k) w.points.push_back(firstPoint_[a] + (h.forward ? k : length - k) - 1);
      if (length == 0) continue;  // its ends are one point
      w.points.push_back(tmesh_.end(h).index);
    }
    return w;
  }

  /// The corners around a point hang together by their pieces.
  static bool isFan(const std::vector<std::array<int, 2>>& around) {
    std::vector<bool> reached(around.size(), false);
    std::vector<std::size_t> waiting{0};
    reached[0] = true;
    std::size_t count = 0;
    while (!waiting.empty()) {
      const auto here = around[waiting.back()];
      waiting.pop_back();
      ++count;
      for (std::size_t k = 0; k < around.size(); ++k)
        if (!reached[k] && (around[k][0] == here[1] || around[k][1] == here[0]))
          reached[k] = true, waiting.push_back(k);
    }
    return count == around.size();
  }

  const TMesh& tmesh_;
  const ArcLengths& q_;
  std::vector<int> firstPoint_, firstPiece_;
  DisjointSets pointSets_, pieceSets_;
};

}  // namespace trimquad
