#pragma once

#include "trimquad/quantize/quantize.h"
#include "trimquad/seamless/seam_basis.h"
#include "trimquad/tmesh/tmesh.h"

namespace trimquad {

/// How quantized arc lengths bind a map: the nodes of the T-mesh as points whose coordinates differ along
/// every arc, and along every free piece of the boundary with its virtual arcs, by whole numbers of quads;
/// critical nodes are vertices of the mesh. Together the relations reach all nodes and settle all
/// translations of the seams, since patches are disks.
GridPoints gridPoints(const SurfaceMesh& mesh, const SeamGraph& seams, const TMesh& tmesh,
                      const Quantization& quantization);

}  // namespace trimquad
