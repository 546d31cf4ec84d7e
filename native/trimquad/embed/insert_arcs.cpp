#include "trimquad/embed/insert_arcs.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "trimquad/base/error.h"
#include "trimquad/mesh/replace_triangles.h"

namespace trimquad {
namespace {

using Eigen::Vector3d;
using Origin = RefinedMesh::Origin;

/// Rounded places keep this far from the ends of what they are inside of, relative to it.
constexpr double kInside = 1e-9;

/// A straight line in a triangle's chart: a side of the triangle, u = constant or v = constant, or a cut.
struct Line {
  enum class Kind { Side, U, V, Cut } kind;
  Quanta number;
  friend auto operator<=>(const Line&, const Line&) = default;
};

struct Segment {
  VertexHandle from, to;
  int direction;  ///< quarter turns from +u
  Line line;
};

/// A convex polygon, perhaps with straight angles.
struct Cell {
  std::vector<VertexHandle> vertex;
  std::vector<Line> line;  ///< of the side from a vertex to the next
  int cuts = 0;
};

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

class Insertion {
 public:
  Insertion(const Parametrization& map, const TMesh& tmesh)
      : map_(map), input_(map.mesh), tmesh_(tmesh), onEdge_(input_.n_edges()), segments_(input_.n_faces()) {
    result_.surface = unrefined(input_);
  }

  CutSurface run() && {
    for (const auto& node : tmesh_.nodes)
      result_.node.push_back(node.place ? std::optional(vertexAt(*node.place)) : std::nullopt);
    for (const auto& arc : tmesh_.arcs) result_.arc.push_back(pathOf(arc));
    std::sort(crossed_.begin(), crossed_.end());
    for (const auto e : crossed_) sortAlong(e);
    for (const auto& red : tmesh_.redSegments) result_.redSegment.push_back(pathOf(red));
    for (const auto f : cutTriangles())
      for (const Cell& cell : cellsOf(f)) triangulate(cell, f);
    replaceTriangles(result_.surface.mesh, parts_, crossed_);
    for (std::size_t p = 1; p < parts_.size(); ++p)
      if (parts_[p].whole == parts_[p - 1].whole) result_.surface.faceOrigin.push_back(parts_[p].whole.idx());
    return std::move(result_);
  }

 private:
  VertexHandle addVertex(const Origin& origin) {
    result_.surface.vertexOrigin.push_back(origin);
    return result_.surface.mesh.add_vertex(placeInSpace(input_, origin));
  }

  VertexHandle vertexAt(const SurfacePoint& x) {
    if (const auto* v = std::get_if<VertexHandle>(&x.element)) return *v;
    const auto found = vertexOf_.find(x);
    if (found != vertexOf_.end()) return found->second;
    const VertexHandle v = addVertex(originOf(map_, x));
    vertexOf_[x] = v;
    if (const auto* e = std::get_if<EdgeHandle>(&x.element)) {
      if (onEdge_[e->idx()].empty()) crossed_.push_back(*e);
      onEdge_[e->idx()].push_back({x, v});
    }
    return v;
  }

  EdgePath pathOf(const TMesh::Arc& arc) {
    EdgePath path;
    for (const auto& leg : arc.legs) {
      if (path.empty()) path.push_back(vertexAt(leg.from));
      path.push_back(vertexAt(leg.to));
      if (leg.alongEdge) continue;
      const Line line{leg.direction % 2 == 0 ? Line::Kind::V : Line::Kind::U, leg.constant};
      segments_[input_.face_handle(leg.side).idx()].push_back(
          {path[path.size() - 2], path.back(), leg.direction, line});
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

  /// In the direction of the edge's halfedge 0.
  void sortAlong(EdgeHandle e) {
    auto& points = onEdge_[e.idx()];
    const HalfedgeHandle side = chartSide(input_, e);
    std::sort(points.begin(), points.end(),
              [&](const auto& a, const auto& b) { return compareAlong(map_, side, a.first, b.first) < 0; });
    if (side != input_.halfedge_handle(e, 0)) std::reverse(points.begin(), points.end());
  }

  /// Those that an arc passes through or has a vertex on, ascending.
  std::vector<FaceHandle> cutTriangles() const {
    std::vector<FaceHandle> triangles;
    for (const auto f : input_.faces())
      if (!segments_[f.idx()].empty()) triangles.push_back(f);
    for (const auto e : crossed_)
      for (const int k : {0, 1})
        if (const auto f = input_.face_handle(input_.halfedge_handle(e, k)); f.is_valid())
          triangles.push_back(f);
    std::sort(triangles.begin(), triangles.end());
    triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
    return triangles;
  }

  /// The triangle's outline with all points on it.
  Cell outline(FaceHandle f) const {
    Cell cell;
    Quanta side = 0;
    for (const auto h : input_.fh_range(f)) {
      cell.vertex.push_back(input_.from_vertex_handle(h));
      cell.line.push_back({Line::Kind::Side, side});
      auto points = onEdge_[input_.edge_handle(h).idx()];
      if (input_.halfedge_handle(input_.edge_handle(h), 0) != h) std::reverse(points.begin(), points.end());
      for (const auto& [x, v] : points) {
        cell.vertex.push_back(v);
        cell.line.push_back({Line::Kind::Side, side});
      }
      ++side;
    }
    return cell;
  }

  struct Spoke {
    VertexHandle to;
    Line line;
    int direction = 0;
  };

  /// What the segments cut the triangle into. Around each vertex the spokes stand counter-clockwise; those of
  /// a vertex on the outline begin with the way on along it, and end with the way back.
  std::vector<Cell> cellsOf(FaceHandle f) const {
    const Cell whole = outline(f);
    if (segments_[f.idx()].empty()) return {whole};
    std::map<VertexHandle, std::vector<Spoke>> spokes;
    for (const Segment& s : segments_[f.idx()]) {
      spokes[s.from].push_back({s.to, s.line, s.direction});
      spokes[s.to].push_back({s.from, s.line, (s.direction + 2) & 3});
    }
    for (auto& [v, around] : spokes)
      std::sort(around.begin(), around.end(),
                [](const Spoke& a, const Spoke& b) { return a.direction < b.direction; });
    const std::size_t n = whole.vertex.size();
    std::vector<FixedVector> sides;
    for (const auto h : input_.fh_range(f)) sides.push_back(map_.to(h) - map_.from(h));
    for (std::size_t k = 0; k < n; ++k) {
      auto& around = spokes[whole.vertex[k]];
      // All inner spokes lie within 180 degrees to the left of the side: start with the first there.
      const FixedVector side = sides[whole.line[k].number];
      std::sort(around.begin(), around.end(), [&](const Spoke& a, const Spoke& b) {
        TRIMQUAD_ASSERT(sign(cross(side, rotated({1, 0}, a.direction))) > 0);
        return a.direction != b.direction &&
               sign(cross(rotated({1, 0}, a.direction), rotated({1, 0}, b.direction))) > 0;
      });
      const std::size_t last = (k + n - 1) % n;
      around.insert(around.begin(), {whole.vertex[(k + 1) % n], whole.line[k]});
      around.push_back({whole.vertex[last], whole.line[last]});
    }
    return cellsBetween(spokes, whole);
  }

  static std::vector<Cell> cellsBetween(const std::map<VertexHandle, std::vector<Spoke>>& spokes,
                                        const Cell& whole) {
    std::set<std::pair<VertexHandle, VertexHandle>> walked;
    for (std::size_t k = 0; k < whole.vertex.size(); ++k)  // the outside is no cell
      walked.insert({whole.vertex[(k + 1) % whole.vertex.size()], whole.vertex[k]});
    std::vector<Cell> cells;
    for (const auto& [start, around] : spokes)
      for (const Spoke& first : around) {
        if (walked.contains({start, first.to})) continue;
        Cell cell;
        VertexHandle v = start;
        const Spoke* spoke = &first;
        while (walked.insert({v, spoke->to}).second) {
          cell.vertex.push_back(v);
          cell.line.push_back(spoke->line);
          const auto& there = spokes.at(spoke->to);
          std::size_t back = 0;
          while (there[back].to != v) ++back;
          v = spoke->to;
          spoke = &there[(back + there.size() - 1) % there.size()];
        }
        TRIMQUAD_ASSERT(v == start && cell.vertex.size() >= 3);
        cells.push_back(std::move(cell));
      }
    return cells;
  }

  void triangulate(const Cell& cell, FaceHandle f) {
    const std::size_t n = cell.vertex.size();
    if (n == 3) {
      parts_.push_back({f, {cell.vertex[0], cell.vertex[1], cell.vertex[2]}});
      return;
    }
    // Cut along the shortest diagonal that does not run along a side.
    std::optional<std::tuple<double, std::size_t, std::size_t>> best;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = i + 2; j < n; ++j) {
        const Line &a = cell.line[i], &b = cell.line[(i + n - 1) % n], &c = cell.line[j],
                   &d = cell.line[j - 1];
        if (a == c || a == d || b == c || b == d) continue;
        const auto& mesh = result_.surface.mesh;
        const double length = (mesh.point(cell.vertex[i]) - mesh.point(cell.vertex[j])).squaredNorm();
        if (!best || length < std::get<0>(*best)) best = {length, i, j};
      }
    TRIMQUAD_ASSERT(best);
    const auto [length, i, j] = *best;
    const Line diagonal{Line::Kind::Cut, cell.cuts};
    Cell left, right;
    left.cuts = right.cuts = cell.cuts + 1;
    for (std::size_t k = 0; k < n; ++k) {
      Cell& part = i <= k && k < j ? left : right;
      part.vertex.push_back(cell.vertex[k]);
      part.line.push_back(cell.line[k]);
      if (k == i) {
        right.vertex.push_back(cell.vertex[i]);
        right.line.push_back(diagonal);
      }
      if (k + 1 == j) {
        left.vertex.push_back(cell.vertex[j]);
        left.line.push_back(diagonal);
      }
    }
    triangulate(left, f);
    triangulate(right, f);
  }

  const Parametrization& map_;
  const SurfaceMesh& input_;
  const TMesh& tmesh_;
  std::vector<std::vector<std::pair<SurfacePoint, VertexHandle>>> onEdge_;  ///< by edge
  std::vector<std::vector<Segment>> segments_;                              ///< by face
  std::map<SurfacePoint, VertexHandle> vertexOf_;
  std::vector<EdgeHandle> crossed_;
  std::vector<TrianglePart> parts_;
  CutSurface result_;
};

}  // namespace

CutSurface insertArcs(const Parametrization& map, const TMesh& tmesh) {
  return Insertion(map, tmesh).run();
}

}  // namespace trimquad
