#pragma once

#include <optional>
#include <vector>

#include "trimquad/field/cross_field.h"

namespace trimquad {

/// Where charts of a map meet: interior edges across which coordinates change by a quarter-turn rotation and
/// a translation. Translations are shared by the edges of one branch.
struct SeamGraph {
  struct Crossing {
    int branch;
    bool forward;  ///< the branch's transition applies as it is; otherwise its inverse
  };
  std::vector<std::optional<Crossing>> crossing;  ///< by halfedge index, from its face to the opposite one
  std::vector<int> rotation;                      ///< by branch, quarter turns
  std::optional<int> outerLoop;                   ///< of a plane region, in the order of boundaryLoops
};

/// The seams that a field needs: a path that opens a tube, so that its period is free. Everything else is one
/// chart. \pre a field without singularities on a region of genus 0
SeamGraph seamGraph(const SurfaceMesh& mesh, const CrossField& field);

}  // namespace trimquad
