#include "trimquad/embed/insert_arcs.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <span>

#include "trimquad/base/error.h"
#include "trimquad/embed/exact_arcs.h"
#include "trimquad/mesh/replace_triangles.h"

namespace trimquad {
namespace {

using Eigen::Vector3d;
using Origin = RefinedMesh::Origin;

/// Rounded places keep this far from the ends of what they are inside of, relative to it.
constexpr double kInside = 1e-9;

/// A corner of a convex polygon, which may have straight angles, and the side from it to the next.
struct CellCorner {
  VertexHandle vertex;
  ChartLine side;
};

/// What leaves a vertex inside a triangle and along its outline.
struct Spoke {
  int at, to;  ///< in `vertices_`
  int rank;    ///< counter-clockwise around the vertex
  ChartLine line;
  std::size_t twin = 0;
  bool walked = false;  ///< by the cell on its left
};

/// Quarter turns from +u to the axis that is last met before the direction x.
int quadrantOf(FixedVector x) {
  if (x.u > 0 && x.v >= 0) return 0;
  if (x.v > 0) return 1;
  return x.u < 0 ? 2 : 3;
}

Origin originOf(const Parametrization& map, const SurfacePoint& x) {
  const auto& mesh = map.mesh;
  if (const auto* v = std::get_if<VertexHandle>(&x.element)) return {*v};
  if (const auto* e = std::get_if<EdgeHandle>(&x.element)) {
    const HalfedgeHandle side = chartSide(mesh, *e);
    const FixedVector a = map.from(side), b = map.to(side);
    int axis = x.exact == SurfacePoint::Exact::V ? 1 : 0;
    if (x.exact == SurfacePoint::Exact::Both && std::abs(b.v - a.v) > std::abs(b.u - a.u)) axis = 1;
    double t = double(x.position[axis] - a[axis]) / double(b[axis] - a[axis]);
    t = std::clamp(t, kInside, 1 - kInside);
    if (side != mesh.halfedge_handle(*e, 0)) t = 1 - t;
    return {*e, {1 - t, t, 0}};
  }
  const FaceHandle f = std::get<FaceHandle>(x.element);
  Vector3d weights;
  int k = 0;
  for (auto h = mesh.halfedge_handle(f); k < 3; h = mesh.next_halfedge_handle(h), ++k) {
    const HalfedgeHandle far = mesh.next_halfedge_handle(h);
    weights[k] = std::max(kInside, double(cross(map.to(far) - map.from(far), x.position - map.from(far))));
  }
  return {f, weights / weights.sum()};
}

/// Everything is kept in flat arrays: the cost is that of what the arcs cross, and of a copy of the mesh.
class Insertion {
 public:
  Insertion(const Parametrization& map, const TMesh& tmesh, RefinedMesh& surface)
      : map_(map), input_(map.mesh), tmesh_(tmesh), surface_(surface) {
    onEdge_.assign(input_.n_edges(), kNone);
  }

  ArcPaths run() && {
    for (const auto& node : tmesh_.nodes)
      result_.node.push_back(node.place ? std::optional(vertexAt(*node.place)) : std::nullopt);
    for (const auto& arc : tmesh_.arcs) result_.arc.push_back(pathOf(arc));
    result_.crossings = int(origins_.size());
    sortAlongEdges();
    snapCrossings(input_, arcs_);
    for (const auto& red : tmesh_.redSegments) result_.redSegment.push_back(pathOf(red));
    cutTriangles();
    startFrom(input_, surface_);
    addVertices();
    replaceTriangles(surface_.mesh, parts_, crossed_);
    for (std::size_t p = 1; p < parts_.size(); ++p)
      if (parts_[p].whole == parts_[p - 1].whole) surface_.faceOrigin.push_back(parts_[p].whole.idx());
    return std::move(result_);
  }

 private:
  static constexpr int kNone = -1;

  /// A vertex inside an edge.
  struct Crossing {
    SurfacePoint point;
    VertexHandle vertex;
    int before;  ///< the one found on the edge before it, in `crossings_`, if any
  };

  VertexHandle addVertex(const SurfacePoint& x) {
    const VertexHandle v(int(input_.n_vertices() + origins_.size()));
    origins_.push_back(originOf(map_, x));
    places_.push_back(placeInSpace(input_, origins_.back()));
    return v;
  }

  void addVertices() {
    auto& [mesh, vertexOrigin, faceOrigin] = surface_;
    vertexOrigin.insert(vertexOrigin.end(), origins_.begin(), origins_.end());
    mesh.resize(vertexOrigin.size(), mesh.n_edges(), mesh.n_faces());
    for (std::size_t k = 0; k < places_.size(); ++k)
      mesh.set_point(VertexHandle(int(input_.n_vertices() + k)), places_[k]);
  }

  const Vector3d& place(VertexHandle v) const {
    const std::size_t i = std::size_t(v.idx()), n = input_.n_vertices();
    return i < n ? input_.point(v) : places_[i - n];
  }

  VertexHandle vertexAt(const SurfacePoint& x) {
    if (const auto* v = std::get_if<VertexHandle>(&x.element)) return *v;
    if (const auto* e = std::get_if<EdgeHandle>(&x.element)) return vertexOnEdge(*e, x);
    const auto [found, isNew] = inTriangle_.try_emplace(x);
    if (isNew) found->second = addVertex(x);
    return found->second;
  }

  VertexHandle vertexOnEdge(EdgeHandle e, const SurfacePoint& x) {
    int& last = onEdge_[e.idx()];
    for (int k = last; k != kNone; k = crossings_[k].before)
      if (crossings_[k].point == x) return crossings_[k].vertex;
    if (last == kNone) crossed_.push_back(e);
    crossings_.push_back({x, addVertex(x), last});
    last = int(crossings_.size()) - 1;
    return crossings_.back().vertex;
  }

  EdgePath pathOf(const TMesh::Arc& arc) {
    EdgePath path;
    path.reserve(arc.legs.size() + 1);
    for (const auto& leg : arc.legs) {
      if (path.empty()) path.push_back(vertexAt(leg.from));
      path.push_back(vertexAt(leg.to));
      if (leg.alongEdge) continue;
      const ChartLine line{leg.direction % 2 == 0 ? ChartLine::Kind::V : ChartLine::Kind::U, leg.constant};
      segments_.push_back(
          {input_.face_handle(leg.side), {path[path.size() - 2], path.back()}, leg.direction, line});
    }
    return path;
  }

  EdgePath pathOf(const TMesh::RedSegment& red) const {
    EdgePath path{*result_.node[tmesh_.start(red.virtualArcs.front()).index]};
    for (std::size_t k = 0; k + 1 < red.edges.size(); ++k)
      path.push_back(input_.to_vertex_handle(red.edges[k]));
    path.push_back(*result_.node[tmesh_.end(red.virtualArcs.back()).index]);
    return path;
  }

  // --- cutting triangles

  /// The vertices on each edge in the direction of its halfedge 0; from now on `onEdge_` says where they
  /// begin in `along_`.
  void sortAlongEdges() {
    std::sort(crossed_.begin(), crossed_.end());
    std::vector<int> points;
    for (const auto e : crossed_) {
      points.clear();
      for (int k = onEdge_[e.idx()]; k != kNone; k = crossings_[k].before) points.push_back(k);
      const HalfedgeHandle side = chartSide(input_, e);
      std::sort(points.begin(), points.end(), [&](int a, int b) {
        return compareAlong(map_, side, crossings_[a].point, crossings_[b].point) < 0;
      });
      if (side != input_.halfedge_handle(e, 0)) std::reverse(points.begin(), points.end());
      onEdge_[e.idx()] = int(along_.size());
      for (const int k : points) along_.push_back(crossings_[k].vertex);
      along_.push_back(VertexHandle());
    }
  }

  /// Those that an arc passes through or has a vertex on, ascending.
  void cutTriangles() {
    std::stable_sort(segments_.begin(), segments_.end(),
                     [](const ArcSegment& a, const ArcSegment& b) { return a.triangle < b.triangle; });
    std::vector<bool> isCut(input_.n_faces(), false);
    for (const ArcSegment& s : segments_) isCut[s.triangle.idx()] = true;
    for (const auto e : crossed_)
      for (const int k : {0, 1})
        if (const auto f = input_.face_handle(input_.halfedge_handle(e, k)); f.is_valid())
          isCut[f.idx()] = true;
    std::size_t first = 0, end = 0;
    for (int f = 0; f < int(isCut.size()); ++f) {
      if (!isCut[f]) continue;
      for (first = end; end < segments_.size() && segments_[end].triangle.idx() == f;) ++end;
      cut(FaceHandle(f), {segments_.data() + first, end - first});
    }
  }

  void cut(FaceHandle f, std::span<const ArcSegment> segments) {
    findOutline(f);
    if (segments.empty()) return triangulate(f, 0, 0);
    if (segments.size() == 1 && cutInTwo(f, segments.front())) return;
    outline_.swap(cells_);
    addSpokes(f, segments);
    for (std::size_t first = 0; first < spokes_.size(); ++first) {
      if (spokes_[first].walked) continue;
      walk(first);
      triangulate(f, 0, 0);
    }
  }

  /// The triangle's outline with all points on it becomes the cell.
  void findOutline(FaceHandle f) {
    cells_.clear();
    HalfedgeHandle h = input_.halfedge_handle(f);
    for (Quanta side = 0; side < 3; ++side, h = input_.next_halfedge_handle(h)) {
      cells_.push_back({input_.from_vertex_handle(h), {ChartLine::Kind::Side, side}});
      const EdgeHandle e = input_.edge_handle(h);
      if (onEdge_[e.idx()] == kNone) continue;
      const std::size_t first = cells_.size();
      for (int k = onEdge_[e.idx()]; along_[k].is_valid(); ++k)
        cells_.push_back({along_[k], {ChartLine::Kind::Side, side}});
      if (input_.halfedge_handle(e, 0) != h) std::reverse(cells_.begin() + long(first), cells_.end());
    }
  }

  /// The outline, from one of its vertices to another.
  bool cutInTwo(FaceHandle f, const ArcSegment& segment) {
    std::size_t i = cells_.size(), j = i;
    for (std::size_t k = 0; k < cells_.size(); ++k)
      if (cells_[k].vertex == segment.end[0] || cells_[k].vertex == segment.end[1])
        (i < cells_.size() ? j : i) = k;
    if (j == cells_.size()) return false;
    triangulate(f, splitCell(0, i, j, {ChartLine::Kind::Cut, kNone}), 0);
    triangulate(f, 0, 0);
    return true;
  }

  int numberOf(VertexHandle v) const {
    return int(std::lower_bound(vertices_.begin(), vertices_.end(), v) - vertices_.begin());
  }

  /// The segments and the sides of the outline, by vertex and counter-clockwise; around a vertex of the
  /// outline they begin with the way on along it, and end with the way back.
  void addSpokes(FaceHandle f, std::span<const ArcSegment> segments) {
    constexpr int kBack = 4;
    vertices_.clear();
    for (const auto& corner : outline_) vertices_.push_back(corner.vertex);
    for (const ArcSegment& s : segments) vertices_.insert(vertices_.end(), s.end.begin(), s.end.end());
    std::sort(vertices_.begin(), vertices_.end());
    vertices_.erase(std::unique(vertices_.begin(), vertices_.end()), vertices_.end());
    std::array<FixedVector, 3> sides;
    HalfedgeHandle h = input_.halfedge_handle(f);
    for (int k = 0; k < 3; ++k, h = input_.next_halfedge_handle(h)) sides[k] = map_.to(h) - map_.from(h);
    onSide_.assign(vertices_.size(), kNone);
    spokes_.clear();
    for (std::size_t k = 0; k < outline_.size(); ++k) {
      const auto& [vertex, side] = outline_[k];
      const int here = numberOf(vertex), next = numberOf(outline_[(k + 1) % outline_.size()].vertex);
      onSide_[here] = int(side.number);
      spokes_.push_back({here, next, 0, side});
      spokes_.push_back({next, here, kBack, side, 0, true});  // the outside is no cell
    }
    const auto rank = [&](int at, int direction) {
      if (onSide_[at] == kNone) return direction & 3;
      // All inner spokes lie within 180 degrees to the left of the side.
      const FixedVector side = sides[onSide_[at]];
      TRIMQUAD_ASSERT(sign(cross(side, rotated({1, 0}, direction))) > 0);
      return (direction - quadrantOf(side)) & 3;
    };
    for (const ArcSegment& s : segments)
      for (const int k : {0, 1}) {
        const int at = numberOf(s.end[k]);
        spokes_.push_back(
            {at, numberOf(s.end[1 - k]), s.moved[k] ? 1 : rank(at, s.direction + 2 * k), s.line});
      }
    std::sort(spokes_.begin(), spokes_.end(),
              [](const Spoke& a, const Spoke& b) { return a.at != b.at ? a.at < b.at : a.rank < b.rank; });
    findTwins();
  }

  void findTwins() {
    firstSpoke_.assign(vertices_.size() + 1, spokes_.size());
    for (std::size_t k = spokes_.size(); k-- > 0;) firstSpoke_[spokes_[k].at] = k;
    for (std::size_t k = 0; k < spokes_.size(); ++k) {
      std::size_t twin = firstSpoke_[spokes_[k].to];
      while (spokes_[twin].to != spokes_[k].at) ++twin;
      spokes_[k].twin = twin;
    }
  }

  /// Around what lies to the left of a spoke, which becomes the cell.
  void walk(std::size_t first) {
    cells_.clear();
    std::size_t k = first;
    for (; !spokes_[k].walked; k = clockwise(spokes_[k].twin)) {
      spokes_[k].walked = true;
      cells_.push_back({vertices_[spokes_[k].at], spokes_[k].line});
    }
    TRIMQUAD_ASSERT(k == first && cells_.size() >= 3);
  }

  /// The next spoke of the same vertex.
  std::size_t clockwise(std::size_t k) const {
    const int at = spokes_[k].at;
    return (k == firstSpoke_[at] ? firstSpoke_[at + 1] : k) - 1;
  }

  /// The cell from `begin` to the end of `cells_`, along the shortest diagonals that do not run along a side;
  /// takes it from `cells_`. \param cuts  diagonals that bound it
  void triangulate(FaceHandle f, std::size_t begin, int cuts) {
    const std::size_t n = cells_.size() - begin;
    if (n == 3) {
      parts_.push_back({f, {cells_[begin].vertex, cells_[begin + 1].vertex, cells_[begin + 2].vertex}});
      cells_.resize(begin);
      return;
    }
    const auto [i, j] = shortestDiagonal(begin);
    triangulate(f, splitCell(begin, i, j, {ChartLine::Kind::Cut, cuts}), cuts + 1);
    triangulate(f, begin, cuts + 1);
  }

  /// What is on the left of the diagonal of the last cell goes to the end, what is on the right stays.
  /// Returns where the former begins.
  std::size_t splitCell(std::size_t begin, std::size_t i, std::size_t j, const ChartLine& diagonal) {
    const std::size_t n = cells_.size() - begin;
    for (std::size_t k = i; k < j; ++k) cells_.push_back(CellCorner(cells_[begin + k]));
    cells_.push_back({cells_[begin + j].vertex, diagonal});
    cells_[begin + i].side = diagonal;
    cells_.erase(cells_.begin() + long(begin + i) + 1, cells_.begin() + long(begin + j));
    return begin + n - (j - i - 1);
  }

  /// Positions of its ends.
  std::pair<std::size_t, std::size_t> shortestDiagonal(std::size_t begin) const {
    const CellCorner* cell = cells_.data() + begin;
    const std::size_t n = cells_.size() - begin;
    std::pair<std::size_t, std::size_t> best{0, 0};
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = i + 2; j < n; ++j) {
        const ChartLine &a = cell[i].side, &b = cell[(i + n - 1) % n].side, &c = cell[j].side,
                        &d = cell[j - 1].side;
        if (a == c || a == d || b == c || b == d) continue;
        const double length = (place(cell[i].vertex) - place(cell[j].vertex)).squaredNorm();
        if (length < least) least = length, best = {i, j};
      }
    TRIMQUAD_ASSERT(best.second > 0);
    return best;
  }

  const Parametrization& map_;
  const SurfaceMesh& input_;
  const TMesh& tmesh_;
  RefinedMesh& surface_;
  ExactArcs arcs_;
  std::vector<Origin>& origins_ = arcs_.origins;
  std::vector<Vector3d>& places_ = arcs_.places;
  std::vector<EdgeHandle>& crossed_ = arcs_.crossed;
  std::vector<int>& onEdge_ = arcs_.onEdge;  ///< until they are sorted: by edge, its last in `crossings_`
  std::vector<VertexHandle>& along_ = arcs_.along;
  std::vector<ArcSegment>& segments_ = arcs_.segments;
  ArcPaths& result_ = arcs_.paths;
  std::vector<Crossing> crossings_;
  std::map<SurfacePoint, VertexHandle> inTriangle_;
  std::vector<CellCorner> cells_;  ///< being triangulated, the next one last
  // Of the triangle that is being cut:
  std::vector<CellCorner> outline_;
  std::vector<VertexHandle> vertices_;
  std::vector<int> onSide_;  ///< by vertex, if on the outline
  std::vector<Spoke> spokes_;
  std::vector<std::size_t> firstSpoke_;  ///< by vertex
  std::vector<TrianglePart> parts_;
};

}  // namespace

ArcPaths insertArcs(const Parametrization& map, const TMesh& tmesh, RefinedMesh& surface) {
  return Insertion(map, tmesh, surface).run();
}

}  // namespace trimquad
