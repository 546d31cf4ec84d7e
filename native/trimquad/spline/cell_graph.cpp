#include "trimquad/spline/cell_graph.h"

#include <string>

#include "trimquad/base/error.h"

namespace trimquad {

CellGraph::CellGraph(const Parametrization& map, const Progress& progress)
    : map_(map), overlay_(overlayGrid(map, progress)), cone_(coneQuarters(map)) {
  progress.check();
  aligned_.assign(map.mesh.n_edges(), 0);
  for (const auto e : map.aligned) aligned_[e.idx()] = !map.mesh.is_boundary(e);
  joinPieces();
  unrollCells();
  sides_.resize(piecesOf_.size());
  for (int h = 0; h < int(overlay_.halfedges.size()); ++h)
    if (overlay_.edges[h >> 1].grid && !overlay_.edges[h >> 1].border) sides_[cellAt(h)].push_back(h);
}

void CellGraph::joinPieces() {
  cellOfPiece_ = overlay_.cellOfPiece();
  for (int p = 0; p < int(overlay_.pieces.size()); ++p) {
    if (cellOfPiece_[p] == int(piecesOf_.size())) piecesOf_.emplace_back();
    piecesOf_[cellOfPiece_[p]].push_back(p);
  }
}

Transition CellGraph::acrossTriangles(int halfedge) const {
  const auto across = overlay_.halfedges[halfedge ^ 1].meshHalfedge;
  return across.is_valid() ? map_.transition(across) : Transition{};
}

void CellGraph::unrollCells() {
  some_.assign(overlay_.pieces.size(), -1);
  for (int h = 0; h < int(overlay_.halfedges.size()); ++h)
    if (const int p = overlay_.halfedges[h].piece; p >= 0 && some_[p] < 0) some_[p] = h;
  toCell_.resize(overlay_.pieces.size());
  std::vector<char> reached(overlay_.pieces.size(), 0);
  for (const auto& pieces : piecesOf_) {
    const int first = pieces.front();
    std::vector<int> queue{first};
    reached[first] = 1;
    for (std::size_t next = 0; next < queue.size(); ++next) {
      const int p = queue[next];
      int h = some_[p];
      do {
        if (!overlay_.edges[h >> 1].separates()) {
          const int q = overlay_.halfedges[h ^ 1].piece;
          const Transition t = toCell_[p].after(acrossTriangles(h));
          if (!reached[q]) {
            toCell_[q] = t;
            reached[q] = 1;
            queue.push_back(q);
          } else if (!(toCell_[q] == t)) {
            const auto v =
                map_.mesh.from_vertex_handle(map_.mesh.halfedge_handle(overlay_.pieces[p].triangle));
            throw stageError(
                "fit", "a hole that the grid turns around is smaller than a quad; use a smaller edge length",
                "triangle " + std::to_string(overlay_.pieces[p].triangle.idx()), map_.mesh.point(v));
          }
        }
        h = overlay_.halfedges[h].next;
      } while (h != some_[p]);
    }
  }
}

Transition CellGraph::fromAcross(int halfedge) const {
  const int p = overlay_.halfedges[halfedge].piece, q = overlay_.halfedges[halfedge ^ 1].piece;
  return toCell_[p].after(acrossTriangles(halfedge)).after(toCell_[q].inverse());
}

bool CellGraph::isFeature(int halfedge) const {
  const auto h = overlay_.halfedges[halfedge].meshHalfedge;
  return h.is_valid() && aligned_[map_.mesh.edge_handle(h).idx()];
}

FixedVector CellGraph::place(int cell) const {
  const auto& piece = overlay_.pieces[piecesOf_[cell].front()];
  return {2 * piece.cell.u + 1, 2 * piece.cell.v + 1};
}

FixedVector CellGraph::place(FixedVector x) const {
  const auto doubled = [&](Quanta c) { return 2 * (c >> map_.scale.bits) + !map_.scale.isInteger(c); };
  return {doubled(x.u), doubled(x.v)};
}

FixedVector CellGraph::moved(const Transition& t, FixedVector place) const {
  const int bits = map_.scale.bits;
  return rotated(place, t.rotation) +
         FixedVector{2 * (t.translation.u >> bits), 2 * (t.translation.v >> bits)};
}

int CellGraph::nextClockwise(int halfedge) const {
  int h = halfedge;
  do {
    h = overlay_.halfedges[h ^ 1].next;
    if (h < 0) return -1;
  } while (!overlay_.edges[h >> 1].separates());
  return h;
}

int CellGraph::quarters(int point) const {
  const auto& p = overlay_.points[point];
  if (p.border || !p.integer) return 0;
  return p.vertex.is_valid() ? cone_[p.vertex.idx()] : 4;
}

}  // namespace trimquad
