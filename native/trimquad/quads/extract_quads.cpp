#include "trimquad/quads/extract_quads.h"

#include <algorithm>
#include <string>

#include "trimquad/base/error.h"
#include "trimquad/quads/cell_loops.h"
#include "trimquad/quads/disk_cells.h"
#include "trimquad/quads/grid_overlay.h"

namespace trimquad {
namespace {

class Extraction {
 public:
  Extraction(const GridMap& map, const std::vector<VertexHandle>& corners, const Progress& progress)
      : map_(map),
        cone_(coneQuarters(map)),
        overlay_(overlayGrid(map, progress)),
        node_(nodes(corners)),
        loops_(map, overlay_, node_) {
    progress.check();
    markAligned();
    for (int c = 0; c < loops_.cellCount(); ++c) addCell(c);
    gatherPoints();
    checkInvariants();
    makeDisks(quads_, std::move(planar_));
  }

  QuadMesh take() { return std::move(quads_); }

 private:
  const GridOverlay::Edge& edge(const LoopPoint& p) const { return overlay_.edges[p.halfedge >> 1]; }
  const Eigen::Vector3d& position(int point) const { return overlay_.points[point].position; }

  /// Nodes are the points at which the sides of cells end.
  std::vector<bool> nodes(const std::vector<VertexHandle>& corners) {
    corner_.assign(overlay_.points.size(), false);
    for (const auto v : corners) {
      if (!map_.mesh.is_boundary(v))
        throw inputError("extract", "a corner of the boundary lies inside the surface",
                         "vertex " + std::to_string(v.idx()), map_.mesh.point(v));
      corner_[v.idx()] = true;
    }
    for (const auto v : map_.featurePoints) corner_[v.idx()] = true;
    std::vector<bool> node(overlay_.points.size());
    for (size_t p = 0; p < overlay_.points.size(); ++p) {
      const auto& point = overlay_.points[p];
      node[p] = point.integer || corner_[p] || (point.border && point.degree > 2);
      if (point.border) continue;
      const int quarters = !point.integer ? 0 : point.vertex.is_valid() ? cone_[point.vertex.idx()] : 4;
      if (point.integer)
        TRIMQUAD_ASSERT(point.degree == quarters);
      else
        TRIMQUAD_ASSERT(point.degree == 0 || point.degree == 2);
    }
    return node;
  }

  void markAligned() {
    aligned_.assign(map_.mesh.n_edges(), false);
    for (const auto e : map_.aligned) aligned_[e.idx()] = true;
  }

  bool isAligned(const LoopPoint& p) const {
    const auto h = overlay_.halfedges[p.halfedge].meshHalfedge;
    return h.is_valid() && aligned_[map_.mesh.edge_handle(h).idx()];
  }

  void addCell(int c) {
    const auto& piece = overlay_.pieces[loops_.firstPiece(c)];
    const WideQuanta whole = 2 * WideQuanta(map_.scale.one()) * map_.scale.one();
    auto& cell = quads_.cells.emplace_back();
    cell.full = loops_.isFull(c);
    cell.area = double(loops_.doubleArea(c)) / double(whole);
    cell.chart = piece.triangle;
    cell.corner = piece.cell;
    if (cell.full) TRIMQUAD_ASSERT(loops_.doubleArea(c) == whole);
    const bool pinched = loops_.isPinched(c), apart = loops_.loops(c).size() > 1;
    if (pinched || apart) loops_.bringIntoOnePlane(c);
    for (const auto& loop : loops_.loops(c)) {
      auto& polygon = cell.loops.emplace_back();
      for (const auto& p : loop)
        if (p.kept) polygon.push_back({loops_.pointOf(p)});
      if (polygon.size() < 3 || (pinched && cell.full) || hasLoopSide(polygon))
        throw coarseError("extract",
                          "a quad would touch itself, the surface is less than a quad wide there; use a "
                          "shorter edge length",
                          "triangle " + std::to_string(piece.triangle.idx()), position(polygon[0].index));
      addSides(c, loop);
    }
    if (pinched || apart) draw(c);
  }

  /// Whether a side of the polygon ends where it starts.
  static bool hasLoopSide(const QuadMesh::Polygon& polygon) {
    for (size_t k = 0; k < polygon.size(); ++k)
      if (polygon[k] == polygon[(k + 1) % polygon.size()]) return true;
    return false;
  }

  void addSides(int c, const CellLoop& loop) {
    const size_t n = loop.size();
    for (size_t i = 0; i < n;) {
      size_t end = i + 1;
      while (end < n && !loop[end].kept) ++end;
      const QuadPointId from{loops_.pointOf(loop[i])}, to{loops_.pointOf(loop[end % n])};
      const bool border = edge(loop[i]).border;
      bool feature = false;
      for (size_t k = i; k < end; ++k) {
        TRIMQUAD_ASSERT(edge(loop[k]).border == border);
        feature = feature || isAligned(loop[k]);
      }
      if (border) {
        auto& piece = quads_.boundary.emplace_back();
        piece.cell = {c};
        piece.from = from, piece.to = to;
        for (size_t k = i; k <= end; ++k) piece.polyline.push_back(position(loops_.pointOf(loop[k % n])));
      }
      ++(border ? borderSides_ : innerSides_);
      // An inner side is met from both cells, in both directions.
      if (feature && (border || from < to)) quads_.featureEdges.push_back({from, to});
      i = end;
    }
  }

  void draw(int c) {
    auto& planar = planar_.emplace_back(PlanarCell{{c}, {}});
    for (const auto& loop : loops_.loops(c)) {
      auto& corners = planar.loops.emplace_back();
      for (const auto& p : loop)
        if (p.kept) corners.push_back({loops_.pointOf(p), p.at, !overlay_.points[loops_.pointOf(p)].border});
    }
  }

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
    for (auto& cell : quads_.cells)
      for (auto& loop : cell.loops) std::for_each(loop.begin(), loop.end(), rename);
    for (auto& cell : planar_)
      for (auto& loop : cell.loops)
        for (auto& corner : loop) corner.point = number[corner.point];
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
    for (int c = 0; c < loops_.cellCount(); ++c) cells += loops_.doubleArea(c);
    for (const auto f : mesh.faces()) {
      const auto h = mesh.halfedge_handle(f), n = mesh.next_halfedge_handle(h);
      triangles += cross(map_.to(h) - map_.from(h), map_.to(n) - map_.from(h));
    }
    TRIMQUAD_ASSERT(cells == triangles);
  }

  const GridMap& map_;
  const std::vector<int> cone_;
  const GridOverlay overlay_;
  std::vector<bool> corner_;  // by overlay point
  const std::vector<bool> node_;
  CellLoops loops_;
  std::vector<bool> aligned_;       // by mesh edge
  std::vector<PlanarCell> planar_;  // cells with holes or pinched ones
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
