#pragma once

#include <optional>
#include <vector>

#include "trimquad/base/constraint_basis.h"
#include "trimquad/field/cross_field.h"
#include "trimquad/seamless/seam_graph.h"

namespace trimquad {

/// Whole quads, per axis; free where there is none.
using BranchTranslation = std::array<std::optional<int>, 2>;

/// An edge of a triangle that must run along a grid line: both its ends have the same coordinate `axis` in the
/// triangle's chart.
struct AlignedSide {
  HalfedgeHandle side;
  int axis;
};

/// The map's unknowns: translations of the branches, then one point per vertex and sector between seams
/// ("wedge"), constrained to be seamless.
class SeamBasis {
 public:
  /// \param translations  what each branch is fixed to
  SeamBasis(const SurfaceMesh& mesh, const SeamGraph& seams,
            const std::vector<BranchTranslation>& translations, const std::vector<AlignedSide>& aligned);

  int wedge(HalfedgeHandle h) const { return wedge_[h.idx()]; }  ///< of the vertex that h leaves, in h's face
  int wedgeCount() const { return wedgeCount_; }
  int branchCount() const { return branches_; }
  /// Index in x of a wedge's or branch's coordinate.
  int coordinate(int wedge, int axis) const { return 2 * branches_ + 2 * wedge + axis; }
  int translation(int branch, int axis) const { return 2 * branch + axis; }
  const ConstraintBasis& basis() const { return basis_; }

 private:
  int branches_;
  int wedgeCount_ = 0;
  std::vector<int> wedge_;
  ConstraintBasis basis_;
};

}  // namespace trimquad
