#include "trimquad/quantize/short_loops.h"

#include <algorithm>
#include <limits>
#include <set>
#include <tuple>

#include "trimquad/base/disjoint_sets.h"
#include "trimquad/quantize/circuits.h"

namespace trimquad {
namespace {

/// The points and unit edges of a quantized T-mesh: those on arcs, joined where zero arcs and zero patches
/// make them one, and those inside patches.
class GridGraph {
 public:
  struct Edge {
    int low, high;                ///< its points
    std::array<ArcId, 2> across;  ///< arcs that make it longer
    friend auto operator<=>(const Edge& a, const Edge& b) = default;
  };

  GridGraph(const TMesh& tmesh, const ArcLengths& q) : tmesh_(tmesh), q_(q), points_(0), pieces_(0) {
    nextPoint_ = int(tmesh.nodes.size());
    int pieceCount = 0;
    for (const int length : q) {
      firstPoint_.push_back(nextPoint_), firstPiece_.push_back(pieceCount);
      nextPoint_ += std::max(0, length - 1), pieceCount += length;
    }
    points_ = DisjointSets(std::size_t(nextPoint_)), pieces_ = DisjointSets(std::size_t(pieceCount));
    joinZeros();
    addArcs(pieceCount);
    for (const auto& patch : tmesh.patches) addInside(patch);
    std::sort(edges_.begin(), edges_.end());
    std::sort(quads_.begin(), quads_.end());
  }

  /// Groups of edges between the same two points, edges from a point to itself, and the sides of quads that
  /// have all their corners in common.
  std::vector<std::vector<Edge>> shortLoops() const {
    std::vector<std::vector<Edge>> loops;
    for (auto first = edges_.begin(); first != edges_.end();) {
      const auto end = std::find_if(
          first, edges_.end(), [&](const Edge& e) { return e.low != first->low || e.high != first->high; });
      if (end - first > 1 || first->low == first->high) loops.emplace_back(first, end);
      first = end;
    }
    for (auto first = quads_.begin(); first != quads_.end();) {
      const auto end =
          std::find_if(first, quads_.end(), [&](const Quad& q) { return q.corners != first->corners; });
      const auto& c = first->corners;
      if (end - first > 1) loops.push_back({{c[0], c[1], first->across}, {c[2], c[3], first->across}});
      first = end;
    }
    return loops;
  }

  /// The arcs of all patches around the points of a short loop, first those that make it longer.
  std::vector<ArcId> arcsAround(const std::vector<Edge>& loop) {
    std::set<int> points;
    std::set<ArcId> across, others;
    for (const auto& edge : loop) {
      points.insert({edge.low, edge.high});
      across.insert(edge.across.begin(), edge.across.end());
    }
    for (const auto& patch : tmesh_.patches) {
      bool touches = false;
      for (const auto& side : patch.sides)
        for (const int point : walk(side).points) touches = touches || points.contains(points_.root(point));
      if (!touches) continue;
      for (const auto& side : patch.sides)
        for (const HalfArc h : side)
          if (!across.contains(h.arc)) others.insert(h.arc);
    }
    std::vector<ArcId> all(across.begin(), across.end());
    all.insert(all.end(), others.begin(), others.end());
    return all;
  }

 private:
  struct Quad {
    std::array<int, 4> corners;  ///< ascending
    std::array<ArcId, 2> across;
    friend auto operator<=>(const Quad& a, const Quad& b) = default;
  };

  struct Walk {
    std::vector<int> points, pieces;
    std::vector<ArcId> arcs;  ///< by piece
  };

  Walk walk(const TMesh::Side& side) const {
    Walk w;
    w.points.push_back(tmesh_.start(side.front()).index);
    for (const HalfArc h : side) {
      const int a = h.arc.index, length = q_[a];
      for (int k = 0; k < length; ++k) {
        w.pieces.push_back(firstPiece_[a] + (h.forward ? k : length - 1 - k));
        w.arcs.push_back(h.arc);
        if (k > 0) w.points.push_back(firstPoint_[a] + (h.forward ? k : length - k) - 1);
      }
      if (length > 0) w.points.push_back(tmesh_.end(h).index);
    }
    return w;
  }

  void joinZeros() {
    for (std::size_t a = 0; a < q_.size(); ++a)
      if (q_[a] == 0) points_.unite(tmesh_.arcs[a].from.index, tmesh_.arcs[a].to.index);
    for (const auto& patch : tmesh_.patches)
      for (const int axis : {0, 1}) {
        if (lengthOf(patch.sides[1 - axis], q_) > 0) continue;
        const Walk near = walk(patch.sides[axis]), far = walk(patch.sides[axis + 2]);
        const std::size_t n = near.pieces.size();
        for (std::size_t k = 0; k <= n; ++k) points_.unite(near.points[k], far.points[n - k]);
        for (std::size_t k = 0; k < n; ++k) pieces_.unite(near.pieces[k], far.pieces[n - 1 - k]);
      }
  }

  void add(int a, int b, ArcId near, ArcId far) {
    edges_.push_back({std::min(a, b), std::max(a, b), {near, far}});
  }

  void addArcs(int pieceCount) {
    std::vector<bool> added(std::size_t(pieceCount), false);
    for (std::size_t a = 0; a < q_.size(); ++a) {
      if (tmesh_.arcs[a].isVirtual) continue;
      const ArcId id{int(a)};
      const Walk w = walk({HalfArc{id, true}});
      for (std::size_t k = 0; k < w.pieces.size(); ++k) {
        const int piece = pieces_.root(w.pieces[k]);
        if (added[piece]) continue;
        added[piece] = true;
        add(points_.root(w.points[k]), points_.root(w.points[k + 1]), id, id);
      }
    }
  }

  void addInside(const TMesh::Patch& patch) {
    std::array<Walk, 4> side;
    for (std::size_t k = 0; k < 4; ++k) side[k] = walk(patch.sides[k]);
    const int width = int(side[0].pieces.size()), height = int(side[1].pieces.size());
    const auto point = [&](int i, int j) {
      if (j == 0) return points_.root(side[0].points[i]);
      if (j == height) return points_.root(side[2].points[width - i]);
      if (i == 0) return points_.root(side[3].points[height - j]);
      if (i == width) return points_.root(side[1].points[j]);
      return nextPoint_ + (j - 1) * (width - 1) + i - 1;
    };
    for (int j = 1; j < height; ++j)
      for (int i = 0; i < width; ++i)
        add(point(i, j), point(i + 1, j), side[0].arcs[i], side[2].arcs[width - 1 - i]);
    for (int i = 1; i < width; ++i)
      for (int j = 0; j < height; ++j)
        add(point(i, j), point(i, j + 1), side[1].arcs[j], side[3].arcs[height - 1 - j]);
    for (int i = 0; i < width; ++i)
      for (int j = 0; j < height; ++j) {
        std::array<int, 4> corners{point(i, j), point(i + 1, j), point(i, j + 1), point(i + 1, j + 1)};
        std::sort(corners.begin(), corners.end());
        quads_.push_back({corners, {side[0].arcs[i], side[1].arcs[j]}});
      }
    nextPoint_ += std::max(0, width - 1) * std::max(0, height - 1);
  }

  const TMesh& tmesh_;
  const ArcLengths& q_;
  std::vector<int> firstPoint_, firstPiece_;  ///< by arc
  DisjointSets points_, pieces_;
  int nextPoint_;
  std::vector<Edge> edges_;
  std::vector<Quad> quads_;
};

/// A loop needs two circuits at most, and those of a round may leave others as they are. More rounds mean
/// that some cannot become longer: those around a vertex of a single quad.
constexpr int kMostRounds = 32;

class Widening {
 public:
  Widening(const Dual& dual, const Objective& objective, const SeparationTest& separation, ArcLengths& q)
      : objective_(objective), separation_(separation), q_(q), search_(dual) {}

  /// By the cheapest circuit through one of the arcs across the edges; whether there is one.
  bool lengthen(const std::vector<GridGraph::Edge>& loop) {
    std::vector<ArcId> arcs;
    for (const auto& edge : loop) arcs.insert(arcs.end(), edge.across.begin(), edge.across.end());
    std::sort(arcs.begin(), arcs.end());
    arcs.erase(std::unique(arcs.begin(), arcs.end()), arcs.end());
    std::vector<std::tuple<double, std::vector<Circuit::Step>>> ways;
    // What is zero should stay so: a zero piece of the boundary can be what makes the lengths separating.
    for (const int least : {1, 0})
      for (const ArcId a : arcs)
        if (const auto circuit = search_.through(a, 1, [&](ArcId b, int change, int already) {
              return change < 0 || q_[b.index] < least ? kForbidden : cost(b, already);
            })) {
          double sum = 0;
          for (const auto& step : circuit->steps)
            sum += objective_.of(step.arc, q_[step.arc.index] + step.change) -
                   objective_.of(step.arc, q_[step.arc.index]);
          ways.emplace_back(sum, circuit->steps);
        }
    std::stable_sort(ways.begin(), ways.end(),
                     [](const auto& a, const auto& b) { return std::get<0>(a) < std::get<0>(b); });
    for (const auto& [sum, steps] : ways) {
      std::vector<ArcId> touched;
      for (const auto& step : steps) {
        touched.push_back(step.arc);
        q_[step.arc.index] += step.change;
      }
      if (!separation_.fault(q_, touched)) {
        touched_.insert(touched_.end(), touched.begin(), touched.end());
        return true;
      }
      for (const auto& step : steps) q_[step.arc.index] -= step.change;
    }
    return false;
  }

  /// Whether an arc across the edges has been lengthened in this round, so that they may be longer by now.
  bool mayBeLonger(const std::vector<GridGraph::Edge>& loop) const {
    for (const auto& edge : loop)
      for (const ArcId a : edge.across)
        if (std::find(touched_.begin(), touched_.end(), a) != touched_.end()) return true;
    return false;
  }

  void nextRound() { touched_.clear(); }

 private:
  static constexpr double kForbidden = std::numeric_limits<double>::infinity();

  /// What the objective rises by; short circuits win among those that do not make it rise.
  double cost(ArcId a, int already) const {
    constexpr double kLeast = 1e-3;
    const int q = q_[a.index] + already;
    return std::max(kLeast * objective_.weight[a.index], objective_.of(a, q + 1) - objective_.of(a, q));
  }

  const Objective& objective_;
  const SeparationTest& separation_;
  ArcLengths& q_;
  CircuitSearch search_;
  std::vector<ArcId> touched_;
};

}  // namespace

int widenLoops(const Dual& dual, const Objective& objective, const SeparationTest& separation, ArcLengths& q,
               const Progress& progress) {
  const ArcLengths before = q;
  Widening widening(dual, objective, separation, q);
  int count = 0;
  for (int round = 0; round < kMostRounds; ++round) {
    const int countBefore = count;
    widening.nextRound();
    for (const auto& loop : GridGraph(*dual.tmesh, q).shortLoops()) {
      progress.check();
      if (!widening.mayBeLonger(loop) && widening.lengthen(loop)) ++count;
    }
    if (count == countBefore) return count;
  }
  q = before;
  return 0;
}

std::vector<Collapse> shortLoopFaults(const TMesh& tmesh, const ArcLengths& q) {
  GridGraph grid(tmesh, q);
  std::vector<Collapse> faults;
  for (const auto& loop : grid.shortLoops()) faults.push_back({{}, {}, grid.arcsAround(loop)});
  return faults;
}

bool hasShortLoops(const TMesh& tmesh, const ArcLengths& q) {
  return !GridGraph(tmesh, q).shortLoops().empty();
}

}  // namespace trimquad
