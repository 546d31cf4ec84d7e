#include "trimquad/seamless/seam_basis.h"

#include "trimquad/base/error.h"
#include "trimquad/base/fixed.h"

namespace trimquad {

namespace {

/// The terms that `factor` times coordinate `axis` of rotated(x, quarters) has in the coordinates of x, which
/// start at `first`.
void addRotated(std::vector<ConstraintBasis::Term>& terms, int first, int axis, int quarters, int factor) {
  const FixedVector row = rotated(axis == 0 ? FixedVector{1, 0} : FixedVector{0, 1}, -quarters);
  if (row.u != 0) terms.push_back({first, factor * row.u});
  if (row.v != 0) terms.push_back({first + 1, factor * row.v});
}

}  // namespace

void PathTransition::cross(const SeamGraph& seams, const SeamGraph::Crossing& crossing) {
  const int quarters = seams.rotation[crossing.branch];
  const int turn = crossing.forward ? quarters : (4 - quarters) & 3;
  if (!crossing.forward) terms.push_back({crossing.branch, 0, -1});
  rotation = (rotation + turn) & 3;
  offset = rotated(offset, turn);
  for (auto& term : terms) term.rotation = (term.rotation + turn) & 3;
  if (crossing.forward) terms.push_back({crossing.branch, 0, 1});
}

SeamBasis::SeamBasis(const SurfaceMesh& mesh, const SeamGraph& seams, const SeamConstraints& constraints)
    : branches_(int(seams.rotation.size())), wedge_(mesh.n_halfedges(), -1), basis_(0) {
  for (const auto v : mesh.vertices()) {
    for (const auto start : mesh.voh_range(v)) {
      if (mesh.is_boundary(start) || wedge_[start.idx()] >= 0) continue;
      // Clockwise to the start of the sector, then counter-clockwise through it.
      HalfedgeHandle first = start;
      for (;;) {
        const auto across = mesh.opposite_halfedge_handle(first);
        if (mesh.is_boundary(across) || seams.crossing[first.idx()]) break;
        const auto previous = mesh.next_halfedge_handle(across);
        if (previous == start) break;
        first = previous;
      }
      for (HalfedgeHandle h = first;;) {
        wedge_[h.idx()] = wedgeCount_;
        const auto in = mesh.prev_halfedge_handle(h);
        const auto next = mesh.opposite_halfedge_handle(in);
        if (mesh.is_boundary(next) || seams.crossing[in.idx()] || next == first) break;
        h = next;
      }
      ++wedgeCount_;
    }
  }
  basis_ = ConstraintBasis(2 * branches_ + 2 * wedgeCount_ + 2 * constraints.grid.count);
  holdGauge(constraints.grid);
  for (int b = 0; b < int(constraints.translations.size()); ++b)
    for (int axis = 0; axis < 2; ++axis)
      if (const auto& whole = constraints.translations[b][axis])
        TRIMQUAD_ASSERT(basis_.addEquation({{translation(b, axis), 1}}, *whole));
  addGridPoints(mesh, constraints.grid);
  addSeams(mesh, seams);
  for (const auto& [side, axis] : constraints.aligned)
    if (!basis_.addEquation({{coordinate(wedge(side), axis), 1},
                             {coordinate(wedge(mesh.next_halfedge_handle(side)), axis), -1}},
                            0))
      throw stageError("optimize", "the integers of an aligned edge contradict each other",
                       "edge " + std::to_string(mesh.edge_handle(side).idx()),
                       mesh.point(mesh.from_vertex_handle(side)));
  basis_.finish();
}

/// The whole map may be shifted at will, and the grid points where none of them is a vertex.
void SeamBasis::holdGauge(const GridPoints& grid) {
  for (int axis = 0; axis < 2; ++axis) {
    if (grid.count > 0) TRIMQUAD_ASSERT(basis_.addEquation({{gridPoint(0, axis), 1}}, 0));
    if (grid.places.empty() && wedgeCount_ > 0)
      TRIMQUAD_ASSERT(basis_.addEquation({{coordinate(0, axis), 1}}, 0));
  }
}

void SeamBasis::addGridPoints(const SurfaceMesh& mesh, const GridPoints& grid) {
  for (const auto& [from, to, path] : grid.relations)
    for (int axis = 0; axis < 2; ++axis) {
      std::vector<ConstraintBasis::Term> terms{{gridPoint(to, axis), 1}};
      addRotated(terms, gridPoint(from, 0), axis, path.rotation, -1);
      for (const auto& term : path.terms)
        addRotated(terms, translation(term.branch, 0), axis, term.rotation, -term.factor);
      if (!basis_.addEquation(terms, path.offset[axis]))
        throw stageError("optimize", "the integers of the quantization contradict each other");
    }
  for (const auto& [point, corner] : grid.places)
    for (int axis = 0; axis < 2; ++axis)
      if (!basis_.addEquation({{coordinate(wedge(corner), axis), 1}, {gridPoint(point, axis), -1}}, 0))
        throw stageError("optimize", "the integers of a vertex contradict each other",
                         "vertex " + std::to_string(mesh.from_vertex_handle(corner).idx()),
                         mesh.point(mesh.from_vertex_handle(corner)));
}

void SeamBasis::addSeams(const SurfaceMesh& mesh, const SeamGraph& seams) {
  for (const auto h : mesh.halfedges()) {
    const auto& crossing = seams.crossing[h.idx()];
    if (!crossing || !crossing->forward) continue;
    const auto o = mesh.opposite_halfedge_handle(h);
    // Both ends of the edge: image in the opposite chart = R image in this chart + t.
    const std::pair<int, int> ends[] = {{wedge(h), wedge(mesh.next_halfedge_handle(o))},
                                        {wedge(mesh.next_halfedge_handle(h)), wedge(o)}};
    for (const auto& [here, there] : ends)
      for (int axis = 0; axis < 2; ++axis) {
        std::vector<ConstraintBasis::Term> terms{{coordinate(there, axis), 1},
                                                 {translation(crossing->branch, axis), -1}};
        addRotated(terms, coordinate(here, 0), axis, seams.rotation[crossing->branch], -1);
        if (!basis_.addEquation(terms, 0))
          throw stageError("seamless", "the integers of the seams contradict each other",
                           "edge " + std::to_string(h.idx() / 2), mesh.point(mesh.from_vertex_handle(h)));
      }
  }
}

}  // namespace trimquad
