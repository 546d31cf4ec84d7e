#include "trimquad/seamless/seam_basis.h"

#include "trimquad/base/error.h"
#include "trimquad/base/fixed.h"

namespace trimquad {

SeamBasis::SeamBasis(const SurfaceMesh& mesh, const SeamGraph& seams,
                     const std::vector<BranchTranslation>& translations,
                     const std::vector<AlignedSide>& aligned)
    : branches_(int(seams.rotation.size())), wedge_(mesh.n_halfedges(), -1), basis_(0) {
  TRIMQUAD_ASSERT(int(translations.size()) == branches_);
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
  basis_ = ConstraintBasis(2 * branches_ + 2 * wedgeCount_);
  // The whole map may be shifted at will: nothing holds it to the grid where there is no singularity.
  if (wedgeCount_ > 0)
    for (int axis = 0; axis < 2; ++axis) TRIMQUAD_ASSERT(basis_.addEquation({{coordinate(0, axis), 1}}, 0));
  for (int b = 0; b < branches_; ++b)
    for (int axis = 0; axis < 2; ++axis)
      if (translations[b][axis])
        TRIMQUAD_ASSERT(basis_.addEquation({{translation(b, axis), 1}}, *translations[b][axis]));
  for (const auto h : mesh.halfedges()) {
    const auto& crossing = seams.crossing[h.idx()];
    if (!crossing || !crossing->forward) continue;
    const auto o = mesh.opposite_halfedge_handle(h);
    // Both ends of the edge: image in the opposite chart = R image in this chart + t.
    const std::pair<int, int> ends[] = {{wedge(h), wedge(mesh.next_halfedge_handle(o))},
                                        {wedge(mesh.next_halfedge_handle(h)), wedge(o)}};
    for (const auto& [here, there] : ends)
      for (int axis = 0; axis < 2; ++axis) {
        const FixedVector row =
            rotated(axis == 0 ? FixedVector{1, 0} : FixedVector{0, 1}, -seams.rotation[crossing->branch]);
        std::vector<ConstraintBasis::Term> terms{{coordinate(there, axis), 1},
                                                 {translation(crossing->branch, axis), -1}};
        if (row.u != 0) terms.push_back({coordinate(here, 0), -row.u});
        if (row.v != 0) terms.push_back({coordinate(here, 1), -row.v});
        if (!basis_.addEquation(terms, 0))
          throw stageError("seamless", "the integers of the seams contradict each other",
                           "edge " + std::to_string(h.idx() / 2), mesh.point(mesh.from_vertex_handle(h)));
      }
  }
  for (const auto& [side, axis] : aligned)
    TRIMQUAD_ASSERT(basis_.addEquation({{coordinate(wedge(side), axis), 1},
                                        {coordinate(wedge(mesh.next_halfedge_handle(side)), axis), -1}},
                                       0));
  basis_.finish();
}

}  // namespace trimquad
