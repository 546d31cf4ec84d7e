#include "trimquad/tmesh/seeds.h"

#include <algorithm>
#include <limits>
#include <queue>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

/// What decides whether a vertex is a node: the iso-lines that leave it, and which of them run along what.
class VertexSurroundings {
 public:
  VertexSurroundings(const Parametrization& map, const std::vector<bool>& isAligned, VertexHandle v)
      : mesh_(map.mesh),
        isAligned_(isAligned),
        border_(mesh_.is_boundary(v)),
        lines_(isolinesFromVertex(map, v)) {
    for (const auto h : mesh_.voh_range(v)) alignedEdges_ += isAligned_[mesh_.edge_handle(h).idx()];
  }

  const std::vector<IsolineLeg>& lines() const { return lines_; }
  bool singular() const { return !border_ && lines_.size() != 4; }
  bool touchesAligned() const { return alignedEdges_ > 0; }

  /// An aligned curve passes straight through, and nothing else is there.
  bool insideAlignedCurve() const {
    if (alignedEdges_ != 2) return false;
    if (border_) return straightBoundary() && alongAligned(0) && alongAligned(2);
    return lines_.size() == 4 &&
           ((alongAligned(0) && alongAligned(2)) || (alongAligned(1) && alongAligned(3)));
  }

  /// The boundary passes straight through, along a line.
  bool straightBoundary() const { return lines_.size() == 3 && alongBoundary(0) && alongBoundary(2); }

  bool alongAligned(std::size_t k) const { return lines_[k].alongEdge && isAligned_[edge(k).idx()]; }
  bool alongBoundary(std::size_t k) const { return lines_[k].alongEdge && mesh_.is_boundary(edge(k)); }

  /// Line k leads into the surface, beside all aligned and boundary edges.
  bool leadsInside(std::size_t k) const { return !alongAligned(k) && !alongBoundary(k); }

  /// Whether the boundary has a concave peak in the direction of line k. A line is at least 90 degrees away
  /// from both boundary edges if it is neither the first nor the last one of the sector. The boundary is
  /// straight, and extremal nowhere, if both angles are exactly 90.
  bool concavePeak(std::size_t k) const {
    if (!border_ || k == 0 || k + 1 >= lines_.size()) return false;
    return !straightBoundary();
  }

 private:
  EdgeHandle edge(std::size_t k) const { return mesh_.edge_handle(lines_[k].side); }

  const SurfaceMesh& mesh_;
  const std::vector<bool>& isAligned_;
  bool border_;
  int alignedEdges_ = 0;
  std::vector<IsolineLeg> lines_;
};

class SeedSearch {
 public:
  explicit SeedSearch(const Parametrization& map)
      : map_(map),
        mesh_(map.mesh),
        isNode_(map.mesh.n_vertices(), false),
        isFeature_(map.mesh.n_vertices(), false) {
    found_.isAligned.assign(mesh_.n_edges(), false);
    for (const auto e : map.aligned) found_.isAligned[e.idx()] = true;
    for (const auto v : map.featurePoints) isFeature_[v.idx()] = true;
  }

  Seeds run() && {
    const auto cone = coneQuarters(map_);
    std::vector<bool> touchesAligned(mesh_.n_vertices(), false);
    for (const auto e : map_.aligned)
      for (const int k : {0, 1})
        touchesAligned[mesh_.to_vertex_handle(mesh_.halfedge_handle(e, k)).idx()] = true;
    // Most vertices are regular inner ones, which need no closer look.
    for (const auto v : mesh_.vertices())
      if (!mesh_.is_isolated(v) && (cone[v.idx()] != 4 || isFeature_[v.idx()] || touchesAligned[v.idx()]))
        visit(v);
    for (const auto v : closedAlignedCurves())
      addNode(v, TMesh::NodeKind::Feature, VertexSurroundings(map_, found_.isAligned, v), false);
    if (found_.motorcycles.empty() && found_.alignedCurves.empty()) addRegularNode();
    return std::move(found_);
  }

 private:
  void visit(VertexHandle v) {
    const VertexSurroundings here(map_, found_.isAligned, v);
    if (here.singular())
      addNode(v, TMesh::NodeKind::Singular, here, false);
    else if (isFeature_[v.idx()] || (here.touchesAligned() && !here.insideAlignedCurve()))
      addNode(v, TMesh::NodeKind::Feature, here, false);
    else if (!here.touchesAligned())
      for (std::size_t k = 0; k < here.lines().size(); ++k)
        if (here.concavePeak(k)) return addNode(v, TMesh::NodeKind::Boundary, here, true);
  }

  void addNode(VertexHandle v, TMesh::NodeKind kind, const VertexSurroundings& here, bool peaksOnly) {
    const NodeId node{int(found_.nodes.size())};
    found_.nodes.push_back({kind, atVertex(v)});
    isNode_[v.idx()] = true;
    for (std::size_t k = 0; k < here.lines().size(); ++k) {
      if (here.alongAligned(k)) found_.alignedCurves.push_back({node, here.lines()[k]});
      if (here.leadsInside(k) && (!peaksOnly || here.concavePeak(k)))
        found_.motorcycles.push_back({node, here.lines()[k]});
    }
  }

  /// One vertex of each aligned curve that meets no node: the smallest.
  std::vector<VertexHandle> closedAlignedCurves() const {
    std::vector<bool> reached(mesh_.n_edges(), false);
    const auto follow = [&](VertexHandle v, HalfedgeHandle h) {
      for (;;) {
        reached[mesh_.edge_handle(h).idx()] = true;
        v = std::min(v, mesh_.to_vertex_handle(h));
        if (isNode_[mesh_.to_vertex_handle(h).idx()]) return v;
        HalfedgeHandle next;
        for (const auto o : mesh_.voh_range(mesh_.to_vertex_handle(h)))
          if (found_.isAligned[mesh_.edge_handle(o).idx()] && o != mesh_.opposite_halfedge_handle(h))
            next = o;
        if (reached[mesh_.edge_handle(next).idx()]) return v;
        h = next;
      }
    };
    for (const auto& start : found_.alignedCurves) {
      const EdgeHandle e = mesh_.edge_handle(start.leg.side);
      const HalfedgeHandle h = mesh_.halfedge_handle(e, 0);
      if (!reached[e.idx()])
        follow(start.leg.fromVertex,
               mesh_.from_vertex_handle(h) == start.leg.fromVertex ? h : mesh_.opposite_halfedge_handle(h));
    }
    std::vector<VertexHandle> smallest;
    for (const auto e : mesh_.edges()) {
      if (!found_.isAligned[e.idx()] || reached[e.idx()]) continue;
      const HalfedgeHandle h = mesh_.halfedge_handle(e, 0);
      smallest.push_back(follow(mesh_.from_vertex_handle(h), h));
    }
    return smallest;
  }

  /// A vertex inside the surface, as near to the parametric centroid as there is; a point of the largest
  /// triangle where all vertices lie on the boundary. Nearness is measured in one chart, laid out triangle by
  /// triangle.
  void addRegularNode() {
    const NodeId node{int(found_.nodes.size())};
    std::optional<VertexHandle> nearest = vertexNearestCentroid();
    if (nearest) {
      found_.nodes.push_back({TMesh::NodeKind::Regular, atVertex(*nearest)});
      for (const auto& leg : isolinesFromVertex(map_, *nearest)) found_.motorcycles.push_back({node, leg});
      return;
    }
    FaceHandle largest;
    WideQuanta most = 0;
    for (const auto f : mesh_.faces()) {
      const auto h = mesh_.halfedge_handle(f);
      const WideQuanta area =
          cross(map_.to(h) - map_.from(h), map_.from(mesh_.prev_halfedge_handle(h)) - map_.from(h));
      if (area > most) most = area, largest = f;
    }
    FixedVector sum;
    for (const auto h : mesh_.fh_range(largest)) sum = sum + map_.from(h);
    const FixedVector x{sum.u / 3, sum.v / 3};
    found_.nodes.push_back({TMesh::NodeKind::Regular, {largest, x, SurfacePoint::Exact::Both}});
    for (int direction = 0; direction < 4; ++direction)
      found_.motorcycles.push_back({node, isolineFromInside(map_, largest, x, direction)});
  }

  std::optional<VertexHandle> vertexNearestCentroid() const {
    std::vector<std::optional<Transition>> layout(mesh_.n_faces());
    std::queue<FaceHandle> waiting;
    Eigen::Vector2d moment(0, 0);
    double total = 0;
    const auto reach = [&](FaceHandle f, const Transition& t) {
      layout[f.idx()] = t;
      waiting.push(f);
      const auto h = mesh_.halfedge_handle(f);
      const Eigen::Vector2d a = map_.scale.toQuads(t(map_.from(h))), b = map_.scale.toQuads(t(map_.to(h))),
                            c = map_.scale.toQuads(t(map_.from(mesh_.prev_halfedge_handle(h))));
      const double area = (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
      moment += area * (a + b + c) / 3, total += area;
    };
    reach(FaceHandle(0), {});
    while (!waiting.empty()) {
      const FaceHandle f = waiting.front();
      waiting.pop();
      for (const auto h : mesh_.fh_range(f)) {
        const auto other = mesh_.opposite_halfedge_handle(h);
        if (!mesh_.is_boundary(other) && !layout[mesh_.face_handle(other).idx()])
          reach(mesh_.face_handle(other), layout[f.idx()]->after(map_.transition(other)));
      }
    }
    const Eigen::Vector2d centroid = moment / total;
    std::optional<VertexHandle> nearest;
    double least = std::numeric_limits<double>::infinity();
    for (const auto v : mesh_.vertices()) {
      if (mesh_.is_isolated(v) || mesh_.is_boundary(v)) continue;
      const auto h = mesh_.halfedge_handle(v);
      const Eigen::Vector2d x = map_.scale.toQuads((*layout[mesh_.face_handle(h).idx()])(map_.from(h)));
      if ((x - centroid).squaredNorm() < least) least = (x - centroid).squaredNorm(), nearest = v;
    }
    return nearest;
  }

  const Parametrization& map_;
  const SurfaceMesh& mesh_;
  std::vector<bool> isNode_, isFeature_;
  Seeds found_;
};

}  // namespace

Seeds seeds(const Parametrization& map) {
  return SeedSearch(map).run();
}

}  // namespace trimquad
