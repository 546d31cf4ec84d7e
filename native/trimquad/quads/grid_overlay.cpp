#include "trimquad/quads/grid_overlay.h"

#include <algorithm>

#include "trimquad/base/disjoint_sets.h"
#include "trimquad/base/error.h"

namespace trimquad {
namespace {

/// Where a point lies relative to the grid lines, per axis: 2k on line k, 2k + 1 between lines k and k + 1.
/// All that the cutting needs to know about a point, and it turns and shifts with the charts like a vector.
using GridPosition = FixedVector;

struct EdgePoint {
  GridPosition grid;
  FixedVector at;
  int point;
};

struct Corner {
  int halfedge;  ///< leaves the corner, along the polygon
  GridPosition grid;
  FixedVector at;
};
using CornerPolygon = std::vector<Corner>;

class Cutter {
 public:
  Cutter(const Parametrization& map, GridOverlay& overlay)
      : map_(map), mesh_(map.mesh), bits_(map.scale.bits), out_(overlay) {}

  void run(const Progress& progress) {
    addVertices();
    firstEdgePoint_.reserve(mesh_.n_edges() + 1);
    for (const auto e : mesh_.edges()) {
      if ((e.idx() & 1023) == 0) progress.check();
      addEdge(e);
    }
    firstEdgePoint_.push_back(int(edgePoints_.size()));
    for (const auto f : mesh_.faces()) {
      if ((f.idx() & 1023) == 0) progress.check();
      cutTriangle(f);
    }
    countDegrees();
  }

 private:
  GridPosition gridPosition(FixedVector x) const { return {gridIndex(x.u, false), gridIndex(x.v, false)}; }
  Quanta gridIndex(Quanta x, bool fraction) const {
    return 2 * (x >> bits_) + (fraction || !map_.scale.isInteger(x));
  }
  GridPosition transported(GridPosition x, const Transition& t) const {
    return rotated(x, t.rotation) +
           FixedVector{2 * (t.translation.u >> bits_), 2 * (t.translation.v >> bits_)};
  }

  void addVertices() {
    out_.points.resize(mesh_.n_vertices());
    for (const auto v : mesh_.vertices()) {
      auto& p = out_.points[v.idx()];
      p.position = mesh_.point(v);
      p.vertex = v;
      p.border = mesh_.is_boundary(v);
    }
    for (const auto h : mesh_.halfedges())
      if (!mesh_.is_boundary(h) && map_.scale.isInteger(map_.from(h)))
        out_.points[mesh_.from_vertex_handle(h).idx()].integer = true;
  }

  /// The side from whose chart an edge is seen when it is cut.
  HalfedgeHandle firstSide(EdgeHandle e) const {
    const auto h = mesh_.halfedge_handle(e, 0);
    return mesh_.is_boundary(h) ? mesh_.halfedge_handle(e, 1) : h;
  }

  void addEdge(EdgeHandle e) {
    firstEdgePoint_.push_back(int(edgePoints_.size()));
    firstHalfedge_.push_back(int(out_.halfedges.size()));
    const auto side = firstSide(e);
    const FixedVector a = map_.from(side), b = map_.to(side);
    addCrossings(side, a, b);

    const bool border = mesh_.is_boundary(e);
    const bool grid = (a.u == b.u && map_.scale.isInteger(a.u)) || (a.v == b.v && map_.scale.isInteger(a.v));
    const auto other = mesh_.opposite_halfedge_handle(side);
    int from = mesh_.from_vertex_handle(side).idx();
    for (size_t i = firstEdgePoint_.back(); i <= edgePoints_.size(); ++i) {
      const int to = i < edgePoints_.size() ? edgePoints_[i].point : mesh_.to_vertex_handle(side).idx();
      addSegment(from, to, side, other, {grid, border});
      from = to;
    }
    if (border) {
      FixedVector previous = a;
      for (size_t i = firstEdgePoint_.back(); i < edgePoints_.size(); ++i) {
        out_.borderRounding += cross(previous - a, edgePoints_[i].at - a);
        previous = edgePoints_[i].at;
      }
      out_.borderRounding += cross(previous - a, b - a);
    }
  }

  int addSegment(int from, int to, HalfedgeHandle side, HalfedgeHandle other, GridOverlay::Edge edge) {
    const int h = int(out_.halfedges.size());
    out_.halfedges.push_back({from, -1, -1, side, {}});
    out_.halfedges.push_back({to, -1, -1, other, {}});
    out_.edges.push_back(edge);
    return h;
  }

  /// Appends the crossings of the open edge a -> b with the grid lines, in exact order, coinciding ones as
  /// one.
  void addCrossings(HalfedgeHandle side, FixedVector a, FixedVector b) {
    const Quanta one = map_.scale.one();
    Quanta line[2], step[2], left[2];  // next line, direction, how many are left; per axis
    for (int axis = 0; axis < 2; ++axis) {
      const Quanta from = a[axis], to = b[axis];
      const Quanta low = (std::min(from, to) >> bits_) + 1, high = ((std::max(from, to) - 1) >> bits_);
      left[axis] = std::max<Quanta>(0, high - low + 1);
      line[axis] = (from < to ? low : high) * one;
      step[axis] = from < to ? one : -one;
    }
    while (left[0] || left[1]) {
      const int order = !left[0] ? 1 : !left[1] ? -1 : compareCrossings(a, b, 0, line[0], 1, line[1]);
      const int axis = order <= 0 ? 0 : 1;
      addCrossing(side, a, b, axis, line[axis]);
      for (int k = 0; k < 2; ++k)
        if (order == 0 || k == axis) line[k] += step[k], --left[k];
    }
  }

  void addCrossing(HalfedgeHandle side, FixedVector a, FixedVector b, int axis, Quanta c) {
    const int other = 1 - axis;
    WideQuanta numerator = WideQuanta(c - a[axis]) * (b[other] - a[other]), denominator = b[axis] - a[axis];
    if (denominator < 0) numerator = -numerator, denominator = -denominator;
    WideQuanta quotient = numerator / denominator, rest = numerator % denominator;
    if (rest < 0) rest += denominator, --quotient;
    const Quanta below = a[other] + Quanta(quotient);
    const Quanta nearest = below + (2 * rest >= denominator);
    const Quanta on = 2 * (c >> bits_), across = gridIndex(below, rest != 0);

    const double t = double(c - a[axis]) / double(b[axis] - a[axis]);
    GridOverlay::Point p;
    p.position =
        (1 - t) * mesh_.point(mesh_.from_vertex_handle(side)) + t * mesh_.point(mesh_.to_vertex_handle(side));
    p.integer = (across & 1) == 0;
    p.border = mesh_.is_boundary(mesh_.edge_handle(side));
    const auto ordered = [axis](Quanta x, Quanta y) {
      return axis == 0 ? FixedVector{x, y} : FixedVector{y, x};
    };
    edgePoints_.push_back({ordered(on, across), ordered(c, nearest), int(out_.points.size())});
    out_.points.push_back(p);
  }

  void cutTriangle(FaceHandle f) {
    triangle_ = f;
    polygon_.clear();
    for (const auto h : mesh_.fh_range(f)) appendSide(h);
    cut(polygon_, 0, [&](const CornerPolygon& strip) {
      cut(strip, 1, [&](const CornerPolygon& piece) { addPiece(piece); });
    });
  }

  void appendSide(HalfedgeHandle h) {
    const EdgeHandle e = mesh_.edge_handle(h);
    const int first = firstEdgePoint_[e.idx()], count = firstEdgePoint_[e.idx() + 1] - first;
    const int segment = firstHalfedge_[e.idx()];
    const FixedVector start = map_.from(h);
    if (h == firstSide(e)) {
      polygon_.push_back({segment, gridPosition(start), start});
      for (int i = 0; i < count; ++i)
        polygon_.push_back({segment + 2 * (i + 1), edgePoints_[first + i].grid, edgePoints_[first + i].at});
      return;
    }
    const Transition t = count ? map_.transition(firstSide(e)) : Transition{};
    polygon_.push_back({segment + 2 * count + 1, gridPosition(start), start});
    for (int i = count - 1; i >= 0; --i)
      polygon_.push_back(
          {segment + 2 * i + 1, transported(edgePoints_[first + i].grid, t), t(edgePoints_[first + i].at)});
  }

  /// Cuts a convex polygon along all lines of one axis that pass through its inside. Every such line meets
  /// the polygon in exactly two corners; walking to them from the lowest end both ways makes the whole cut
  /// linear.
  template <class Emit>
  void cut(const CornerPolygon& polygon, int axis, const Emit& emit) {
    const auto less = [axis](const Corner& a, const Corner& b) { return a.grid[axis] < b.grid[axis]; };
    const auto [lowest, highest] = std::minmax_element(polygon.begin(), polygon.end(), less);
    const Quanta low = lowest->grid[axis], high = highest->grid[axis];
    const Quanta firstLine = (low & ~Quanta(1)) + 2;
    if (firstLine >= high) return emit(polygon);

    const size_t n = polygon.size();
    size_t start = 0;  // first corner of the run of lowest ones
    while (polygon[start].grid[axis] != low || polygon[(start + n - 1) % n].grid[axis] == low) ++start;
    const auto at = [&](size_t i) -> const Corner& { return polygon[(start + i) % n]; };

    CornerPolygon part, chordUp, chordBack;  // chordBack: the last chord, seen from the rest
    size_t forward = 0, backward = n;
    for (Quanta line = firstLine;; line += 2) {
      size_t f = forward, b = backward;
      if (line < high) {
        while (at(f).grid[axis] < line) ++f;
        while (at(b).grid[axis] < line) --b;
        TRIMQUAD_ASSERT(f < b && at(f).grid[axis] == line && at(b).grid[axis] == line);
      } else {
        f = b = backward;
      }
      part = chordBack;
      for (size_t i = forward; i < f; ++i) part.push_back(at(i));
      if (line < high) {
        addChord(at(f), at(b), 1 - axis, chordUp, chordBack);
        part.insert(part.end(), chordUp.begin(), chordUp.end());
        for (size_t i = b; i < backward; ++i) part.push_back(at(i));
      }
      emit(part);
      if (line >= high) return;
      forward = f, backward = b;
    }
  }

  /// The grid line from corner p to corner q of the triangle's polygon, which runs along `axis`, with the
  /// grid points between them: as polygon corners on the way there, and on the way back.
  void addChord(const Corner& p, const Corner& q, int axis, CornerPolygon& there, CornerPolygon& back) {
    there.clear(), back.clear();
    const Quanta from = p.grid[axis], to = q.grid[axis], step = from < to ? 2 : -2;
    const int end = out_.halfedges[q.halfedge].origin;
    Corner last = p;
    int lastPoint = out_.halfedges[p.halfedge].origin;
    const auto connect = [&](const Corner& corner, int point) {
      const int h = addSegment(lastPoint, point, HalfedgeHandle(), HalfedgeHandle(), {true, false});
      there.push_back({h, last.grid, last.at});
      back.push_back({h + 1, corner.grid, corner.at});
      last = corner;
      lastPoint = point;
    };
    Quanta k = from < to ? (from & ~Quanta(1)) + 2 : ((from + 1) & ~Quanta(1)) - 2;
    for (; from < to ? k < to : k > to; k += step) {
      GridPosition grid = p.grid;
      (axis == 0 ? grid.u : grid.v) = k;
      const FixedVector x{(grid.u >> 1) << bits_, (grid.v >> 1) << bits_};
      connect({-1, grid, x}, addInnerPoint(x));
    }
    connect(q, end);
    std::reverse(back.begin(), back.end());
  }

  int addInnerPoint(FixedVector x) {
    const auto h = mesh_.halfedge_handle(triangle_), n = mesh_.next_halfedge_handle(h);
    const FixedVector a = map_.from(h), b = map_.from(n), c = map_.to(n);
    const double whole = double(cross(b - a, c - a));
    const double wb = double(cross(x - a, c - a)) / whole, wc = double(cross(b - a, x - a)) / whole;
    GridOverlay::Point p;
    p.position = (1 - wb - wc) * mesh_.point(mesh_.from_vertex_handle(h)) +
                 wb * mesh_.point(mesh_.from_vertex_handle(n)) + wc * mesh_.point(mesh_.to_vertex_handle(n));
    p.integer = true;
    out_.points.push_back(p);
    return int(out_.points.size()) - 1;
  }

  void addPiece(const CornerPolygon& polygon) {
    TRIMQUAD_ASSERT(polygon.size() >= 3);
    const int piece = int(out_.pieces.size());
    FixedVector cell = polygon[0].grid;
    WideQuanta area = 0;
    for (size_t i = 0; i < polygon.size(); ++i) {
      const Corner &c = polygon[i], &following = polygon[(i + 1) % polygon.size()];
      auto& h = out_.halfedges[c.halfedge];
      h.next = following.halfedge;
      h.piece = piece;
      h.at = c.at;
      cell.u = std::min(cell.u, c.grid.u);
      cell.v = std::min(cell.v, c.grid.v);
      area += cross(c.at - polygon[0].at, following.at - polygon[0].at);
    }
    out_.pieces.push_back({triangle_, {cell.u >> 1, cell.v >> 1}, area});
  }

  void countDegrees() {
    for (size_t h = 0; h < out_.halfedges.size(); ++h)
      if (out_.edges[h >> 1].separates()) ++out_.points[out_.halfedges[h].origin].degree;
  }

  const Parametrization& map_;
  const SurfaceMesh& mesh_;
  const int bits_;
  GridOverlay& out_;
  std::vector<EdgePoint> edgePoints_;
  std::vector<int> firstEdgePoint_, firstHalfedge_;  // by mesh edge
  FaceHandle triangle_;
  CornerPolygon polygon_;
};

}  // namespace

std::vector<int> GridOverlay::cellOfPiece() const {
  DisjointSets sets(pieces.size());
  for (std::size_t e = 0; e < edges.size(); ++e)
    if (!edges[e].separates()) sets.unite(halfedges[2 * e].piece, halfedges[2 * e + 1].piece);
  std::vector<int> result(pieces.size());
  int cells = 0;
  for (int p = 0; p < int(pieces.size()); ++p) {
    const int root = sets.root(p);
    result[p] = root == p ? cells++ : result[root];
  }
  return result;
}

GridOverlay overlayGrid(const Parametrization& map, const Progress& progress) {
  GridOverlay overlay;
  Cutter(map, overlay).run(progress);
  return overlay;
}

}  // namespace trimquad
