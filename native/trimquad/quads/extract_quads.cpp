#include "trimquad/quads/extract_quads.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>
#include <string>

#include "trimquad/base/error.h"
#include "trimquad/quads/grid_overlay.h"
#include "trimquad/quads/simple_polygons.h"

namespace trimquad {
namespace {

/// A point of a cell's loop, before it is decided which points of the boundary stay.
struct LoopPoint {
  int halfedge;    ///< of the overlay, leaves the point
  FixedVector at;  ///< in the chart in which the loop starts
  bool kept;
};
struct Loop {
  std::vector<LoopPoint> points;
  bool closed;  ///< the chart is the same again after the walk around
};

class DisjointSets {
 public:
  explicit DisjointSets(size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }
  int root(int x) {
    while (parent_[x] != x) x = parent_[x] = parent_[parent_[x]];
    return x;
  }
  /// The smallest member stays the root.
  void unite(int a, int b) {
    a = root(a), b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<int> parent_;
};

class Extraction {
 public:
  Extraction(const GridMap& map, const std::vector<VertexHandle>& corners, const Progress& progress)
      : map_(map), cone_(coneQuarters(map)), overlay_(overlayGrid(map, progress)) {
    markNodes(corners);
    findCells();
    walkLoops();
    progress.check();
    for (size_t c = 0; c < loops_.size(); ++c) shapeCell(int(c));
    gatherPoints();
    checkInvariants();
  }

  QuadMesh take() { return std::move(quads_); }

 private:
  const GridOverlay::Halfedge& halfedge(int h) const { return overlay_.halfedges[h]; }
  const GridOverlay::Edge& edge(int h) const { return overlay_.edges[h >> 1]; }
  int pointOf(const LoopPoint& p) const { return halfedge(p.halfedge).origin; }
  const Eigen::Vector3d& position(int point) const { return overlay_.points[point].position; }

  /// Nodes are the points at which the sides of cells end.
  void markNodes(const std::vector<VertexHandle>& corners) {
    corner_.assign(overlay_.points.size(), false);
    for (const auto v : corners) {
      if (!map_.mesh.is_boundary(v))
        throw inputError("extract", "a corner of the boundary lies inside the surface",
                         "vertex " + std::to_string(v.idx()), map_.mesh.point(v));
      corner_[v.idx()] = true;
    }
    for (const auto v : map_.featurePoints) corner_[v.idx()] = true;
    node_.resize(overlay_.points.size());
    for (size_t p = 0; p < overlay_.points.size(); ++p) {
      const auto& point = overlay_.points[p];
      node_[p] = point.integer || corner_[p] || (point.border && point.degree > 2);
      if (point.border) continue;
      const int quarters = !point.integer ? 0 : point.vertex.is_valid() ? cone_[point.vertex.idx()] : 4;
      if (point.integer)
        TRIMQUAD_ASSERT(point.degree == quarters);
      else
        TRIMQUAD_ASSERT(point.degree == 0 || point.degree == 2);
    }
  }

  /// Pieces that no grid line separates belong to one cell.
  void findCells() {
    DisjointSets sets(overlay_.pieces.size());
    for (size_t e = 0; e < overlay_.edges.size(); ++e)
      if (!overlay_.edges[e].separates())
        sets.unite(halfedge(int(2 * e)).piece, halfedge(int(2 * e + 1)).piece);
    cellOfPiece_.resize(overlay_.pieces.size());
    for (size_t p = 0; p < overlay_.pieces.size(); ++p) {
      const auto& piece = overlay_.pieces[p];
      if (sets.root(int(p)) == int(p)) {
        cellOfPiece_[p] = int(quads_.cells.size());
        quads_.cells.push_back({{}, {}, false, 0, piece.triangle, piece.cell});
        area_.push_back(0);
      } else {
        cellOfPiece_[p] = cellOfPiece_[sets.root(int(p))];
      }
      area_[cellOfPiece_[p]] += piece.doubleArea;
    }
    loops_.resize(quads_.cells.size());
  }

  void walkLoops() {
    std::vector<bool> seen(overlay_.halfedges.size(), false);
    for (int h = 0; h < int(overlay_.halfedges.size()); ++h) {
      if (seen[h] || halfedge(h).piece < 0 || !edge(h).separates()) continue;
      Loop loop = walkLoop(h);
      for (const auto& p : loop.points) seen[p.halfedge] = true;
      loops_[cellOfPiece_[halfedge(h).piece]].push_back(std::move(loop));
    }
  }

  Loop walkLoop(int start) const {
    Loop loop;
    Transition toStart;
    int h = start;
    do {
      loop.points.push_back({h, toStart(halfedge(h).at), bool(node_[halfedge(h).origin])});
      h = halfedge(h).next;
      while (!edge(h).separates()) {
        const auto back = halfedge(h ^ 1).meshHalfedge;
        toStart = toStart.after(map_.transition(back));
        h = halfedge(h ^ 1).next;
      }
    } while (h != start);
    loop.closed = toStart.isIdentity();
    return loop;
  }

  // ---- from loops to polygons

  void shapeCell(int c) {
    auto& cell = quads_.cells[c];
    auto& loops = loops_[c];
    TRIMQUAD_ASSERT(!loops.empty());
    const WideQuanta whole = 2 * WideQuanta(map_.scale.one()) * map_.scale.one();
    cell.area = double(area_[c]) / double(whole);
    if (loops.size() == 1) {
      cell.full = isFull(loops[0]);
      if (cell.full) TRIMQUAD_ASSERT(area_[c] == whole);
      keepEnough(loops[0]);
    } else {
      for (auto& loop : loops)
        for (auto& p : loop.points) p.kept = p.kept || onBoundaryOnly(p);
    }
    for (auto& loop : loops) {
      while (!loop.points[0].kept)
        std::rotate(loop.points.begin(), loop.points.begin() + 1, loop.points.end());
      recordBoundary(c, loop);
    }
    if (loops.size() > 1) orderLoops(c);
    for (const auto& loop : loops) {
      auto& polygon = cell.loops.emplace_back();
      for (const auto& p : loop.points)
        if (p.kept) polygon.push_back({pointOf(p)});
      refuseSelfTouch(polygon);
    }
    if (loops.size() > 1) cutBetweenLoops(c);
  }

  bool isFull(const Loop& loop) const {
    int nodes = 0;
    for (const auto& p : loop.points) {
      if (!edge(p.halfedge).grid) return false;
      if (!p.kept) continue;
      if (!overlay_.points[pointOf(p)].integer) return false;
      ++nodes;
    }
    return nodes == 4;
  }

  /// A vertex of the boundary at which nothing else ends: it belongs to this cell alone.
  bool onBoundaryOnly(const LoopPoint& p) const {
    const auto& point = overlay_.points[pointOf(p)];
    return point.border && point.degree == 2;
  }

  /// Keeps further vertices of the boundary, the farthest from its chord first, until the polygon has three
  /// corners and a positive area.
  void keepEnough(Loop& loop) const {
    while (keptCount(loop) < 3 || keptArea(loop) <= 0) {
      const auto farthest = farthestVertex(loop);
      if (!farthest) return;
      loop.points[*farthest].kept = true;
    }
  }

  static int keptCount(const Loop& loop) {
    return int(std::count_if(loop.points.begin(), loop.points.end(), [](const auto& p) { return p.kept; }));
  }

  static WideQuanta keptArea(const Loop& loop) {
    std::optional<FixedVector> origin, last;
    WideQuanta area = 0;
    for (const auto& p : loop.points) {
      if (!p.kept) continue;
      if (!origin) origin = last = p.at;
      area += cross(*last - *origin, p.at - *origin);
      last = p.at;
    }
    return area;
  }

  std::optional<size_t> farthestVertex(const Loop& loop) const {
    const size_t n = loop.points.size();
    size_t first = 0;
    while (first < n && !loop.points[first].kept) ++first;
    std::optional<size_t> farthest;
    if (first == n) {  // nothing to measure from yet
      for (size_t i = 0; i < n && !farthest; ++i)
        if (onBoundaryOnly(loop.points[i])) farthest = i;
      return farthest;
    }
    double distance = -1;
    for (size_t i = first; i < first + n;) {
      size_t end = i + 1;
      while (!loop.points[end % n].kept) ++end;
      const Eigen::Vector3d a = position(pointOf(loop.points[i % n])),
                            b = position(pointOf(loop.points[end % n]));
      for (size_t k = i + 1; k < end; ++k) {
        const auto& p = loop.points[k % n];
        if (!onBoundaryOnly(p)) continue;
        const Eigen::Vector3d x = position(pointOf(p)) - a, chord = b - a;
        const double t = chord.isZero() ? 0 : std::clamp(x.dot(chord) / chord.squaredNorm(), 0.0, 1.0);
        const double d = (x - t * chord).norm();
        if (d > distance) distance = d, farthest = k % n;
      }
      i = end;
    }
    return farthest;
  }

  void recordBoundary(int c, const Loop& loop) {
    const size_t n = loop.points.size();
    for (size_t i = 0; i < n;) {
      size_t end = i + 1;
      while (end < n && !loop.points[end].kept) ++end;
      const int from = pointOf(loop.points[i]), to = pointOf(loop.points[end % n]);
      const bool border = edge(loop.points[i].halfedge).border;
      bool feature = false;
      for (size_t k = i; k < end; ++k) {
        TRIMQUAD_ASSERT(edge(loop.points[k].halfedge).border == border);
        feature = feature || isAligned(loop.points[k].halfedge);
      }
      if (border) {
        auto& piece = quads_.boundary.emplace_back();
        piece.cell = {c};
        piece.from = {from}, piece.to = {to};
        for (size_t k = i; k <= end; ++k) piece.polyline.push_back(position(pointOf(loop.points[k % n])));
      }
      ++(border ? borderSides_ : innerSides_);
      // An inner side is met twice, once in each direction; its first point's number tells them apart.
      if (feature && (border || from < to))
        quads_.featureEdges.push_back({QuadPointId{from}, QuadPointId{to}});
      i = end;
    }
  }

  bool isAligned(int h) {
    const auto m = halfedge(h).meshHalfedge;
    if (!m.is_valid() || map_.aligned.empty()) return false;
    if (aligned_.empty()) {
      aligned_.assign(map_.mesh.n_edges(), false);
      for (const auto e : map_.aligned) aligned_[e.idx()] = true;
    }
    return aligned_[map_.mesh.edge_handle(m).idx()];
  }

  void refuseSelfTouch(const QuadMesh::Polygon& polygon) const {
    QuadMesh::Polygon sorted = polygon;
    std::sort(sorted.begin(), sorted.end());
    const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
    if (twice != sorted.end() || sorted.size() < 3)
      throw stageError(
          "extract",
          "a quad would touch itself, the surface is less than a quad wide there; use a shorter edge length",
          twice != sorted.end() ? "point " + std::to_string(twice->index) : "cell",
          position(polygon[0].index));
  }

  // ---- cells with holes

  /// Brings the loops of a cell into one chart and the outer one to the front.
  void orderLoops(int c) {
    auto& loops = loops_[c];
    if (!bringIntoOneChart(loops)) projectLoops(loops);
    const auto outer =
        std::find_if(loops.begin(), loops.end(), [](const Loop& l) { return keptArea(l) > 0; });
    if (outer != loops.end()) std::rotate(loops.begin(), outer, outer + 1);
  }

  /// False where the cell winds around a point at which the charts do not agree: a singularity in the hole.
  bool bringIntoOneChart(std::vector<Loop>& loops) const {
    std::map<int, Transition> toRoot;  // from the chart of each piece
    toRoot[halfedge(loops[0].points[0].halfedge).piece] = Transition{};
    // One half-edge per piece is enough to walk around it.
    std::vector<int> queue{loops[0].points[0].halfedge};
    for (size_t i = 0; i < queue.size(); ++i) {
      const Transition here = toRoot.at(halfedge(queue[i]).piece);
      int h = queue[i];
      do {
        if (!edge(h).separates()) {
          const Transition there = here.after(map_.transition(halfedge(h ^ 1).meshHalfedge));
          const auto [known, isNew] = toRoot.emplace(halfedge(h ^ 1).piece, there);
          if (isNew)
            queue.push_back(h ^ 1);
          else if (!(known->second == there))
            return false;
        }
        h = halfedge(h).next;
      } while (h != queue[i]);
    }
    for (auto& loop : loops)
      for (auto& p : loop.points) {
        const auto& h = halfedge(p.halfedge);
        p.at = toRoot.at(h.piece)(h.at);
      }
    return true;
  }

  /// Seen in space instead: along the normal of the longest loop, which is the outer one.
  void projectLoops(std::vector<Loop>& loops) const {
    const auto vectorArea = [&](const Loop& loop) {
      Eigen::Vector3d area = Eigen::Vector3d::Zero();
      const Eigen::Vector3d origin = position(pointOf(loop.points[0]));
      for (size_t i = 0; i < loop.points.size(); ++i)
        area += (position(pointOf(loop.points[i])) - origin)
                    .cross(position(pointOf(loop.points[(i + 1) % loop.points.size()])) - origin);
      return area;
    };
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    for (const auto& loop : loops)
      if (vectorArea(loop).norm() > normal.norm()) normal = vectorArea(loop);
    const Eigen::Vector3d x = normal.unitOrthogonal(), y = normal.normalized().cross(x);
    const Eigen::Vector3d origin = position(pointOf(loops[0].points[0]));
    double size = 0;
    for (const auto& loop : loops)
      for (const auto& p : loop.points) size = std::max(size, (position(pointOf(p)) - origin).norm());
    const FixedScale fine = FixedScale::fitting(1);
    for (auto& loop : loops)
      for (auto& p : loop.points) {
        const Eigen::Vector3d d = (position(pointOf(p)) - origin) / size;
        p.at = fine.round(Eigen::Vector2d(d.dot(x), d.dot(y)));
      }
  }

  void cutBetweenLoops(int c) {
    auto& cell = quads_.cells[c];
    std::vector<std::vector<FixedVector>> charts;
    for (const auto& loop : loops_[c]) {
      auto& chart = charts.emplace_back();
      for (const auto& p : loop.points)
        if (p.kept) chart.push_back(p.at);
    }
    for (const auto& polygon : simplePolygons(charts)) {
      auto& simple = cell.simple.emplace_back();
      for (const auto& [loop, corner] : polygon) simple.push_back(cell.loops[loop][corner]);
    }
  }

  // ---- the result

  /// Numbers the points that cells use, and renames them everywhere.
  void gatherPoints() {
    std::vector<int> number(overlay_.points.size(), -1);
    for (const auto& cell : quads_.cells)
      for (const auto& loop : cell.loops)
        for (const auto id : loop) number[id.index] = 0;
    for (size_t p = 0; p < number.size(); ++p) {
      if (number[p] < 0) continue;
      number[p] = int(quads_.points.size());
      const auto& point = overlay_.points[p];
      const auto kind = point.integer                      ? QuadMesh::PointKind::Grid
                        : corner_[p]                       ? QuadMesh::PointKind::Corner
                        : point.border && point.degree > 2 ? QuadMesh::PointKind::Crossing
                                                           : QuadMesh::PointKind::Boundary;
      quads_.points.push_back({point.position, kind, point.border, point.border ? 0 : point.degree});
    }
    const auto rename = [&](QuadPointId& id) { id.index = number[id.index]; };
    for (auto& cell : quads_.cells) {
      for (auto& loop : cell.loops) std::for_each(loop.begin(), loop.end(), rename);
      for (auto& polygon : cell.simple) std::for_each(polygon.begin(), polygon.end(), rename);
    }
    for (auto& piece : quads_.boundary) rename(piece.from), rename(piece.to);
    for (auto& side : quads_.featureEdges) rename(side[0]), rename(side[1]);
    std::sort(quads_.featureEdges.begin(), quads_.featureEdges.end());
  }

  void checkInvariants() {
    const auto& mesh = map_.mesh;
    TRIMQUAD_ASSERT(innerSides_ % 2 == 0);
    int euler = int(quads_.points.size()) - borderSides_ - innerSides_ / 2;
    for (const auto& cell : quads_.cells) euler += 2 - int(cell.loops.size());
    int ofSurface = int(mesh.n_faces()) - int(mesh.n_edges());
    for (const auto v : mesh.vertices()) ofSurface += !mesh.is_isolated(v);
    TRIMQUAD_ASSERT(euler == ofSurface);
    quads_.eulerCharacteristic = euler;

    WideQuanta cells = 0, triangles = overlay_.borderRounding;
    for (const auto area : area_) cells += area;
    for (const auto f : mesh.faces()) {
      const auto h = mesh.halfedge_handle(f), n = mesh.next_halfedge_handle(h);
      triangles += cross(map_.to(h) - map_.from(h), map_.to(n) - map_.from(h));
    }
    TRIMQUAD_ASSERT(cells == triangles);
  }

  const GridMap& map_;
  const std::vector<int> cone_;
  const GridOverlay overlay_;
  std::vector<bool> corner_, node_;  // by overlay point
  std::vector<int> cellOfPiece_;
  std::vector<WideQuanta> area_;          // by cell: twice the area, quanta squared
  std::vector<std::vector<Loop>> loops_;  // by cell
  std::vector<bool> aligned_;             // by mesh edge
  int borderSides_ = 0, innerSides_ = 0;
  QuadMesh quads_;
};

}  // namespace

QuadMesh extractQuads(const GridMap& map, const std::vector<VertexHandle>& corners,
                      const Progress& progress) {
  verify(map, true);
  return Extraction(map, corners, progress).take();
}

}  // namespace trimquad
