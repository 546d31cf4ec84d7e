#pragma once

#include <optional>
#include <vector>

#include "trimquad/field/cross_field.h"

namespace trimquad {

/// Where charts of a map meet: interior edges across which coordinates change by a quarter-turn rotation and
/// a translation. Translations are shared by the edges of one branch: a chain of edges from node to node, a
/// node being a singular vertex, a boundary vertex, or one where several branches meet.
struct SeamGraph {
  struct Crossing {
    int branch;
    bool forward;  ///< the branch's transition applies as it is; otherwise its inverse
  };
  std::vector<std::optional<Crossing>> crossing;  ///< by halfedge index, from its face to the opposite one
  std::vector<int> rotation;                      ///< by branch, quarter turns
  /// By face index: quarter turns that comb the field, so that its directions agree across all edges but
  /// seams, and turn by the branch's rotation there.
  std::vector<int> combing;
  std::optional<int>
      outerLoop;      ///< of a region that is mapped as one plane chart, in the order of boundaryLoops
  bool tube = false;  ///< whether the one branch opens a tube
};

/// The seams that a field needs. A plane region with holes around which the field turns as in the plane needs
/// none; a tube one path that opens it, so that its period is free; all others the shortest paths that cut
/// the surface open to a disk with every singularity on its rim (Erickson and Whittlesey 2005).
SeamGraph seamGraph(const SurfaceMesh& mesh, const CrossField& field);

/// The seams of a region of genus 0 that is mapped as one plane chart whatever the field: none.
/// \param outerLoop  in the order of boundaryLoops
SeamGraph withoutSeams(const SurfaceMesh& mesh, const CrossField& field, int outerLoop);

}  // namespace trimquad
