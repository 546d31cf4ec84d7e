#pragma once

#include <functional>

#include "trimquad/base/progress.h"
#include "trimquad/embed/embedded_tmesh.h"

namespace trimquad {

/// Moves the arcs until none has length zero and no patch has a side of length zero, by the paper's operators
/// (section 6.1): zero arcs are collapsed onto one of their ends, which pulls along the other arcs there;
/// zero patches with T-joints are split there; zero patches between two arcs are closed. Arcs move only
/// through the patches that they border, so they stay in their homotopy class. Terminates without zeros for
/// lengths that are separating (paper, Prop. 6.1). \param input           what the embedding's mesh refines
/// \param afterOperation  called after each one, for tests
void collapseZeros(const SurfaceMesh& input, EmbeddedTMesh& embedded, const Progress& progress,
                   const std::function<void(const EmbeddedTMesh&)>& afterOperation = {});

}  // namespace trimquad
