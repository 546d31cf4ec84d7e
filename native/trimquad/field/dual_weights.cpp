#include "trimquad/field/dual_weights.h"

#include <algorithm>

namespace trimquad {

std::vector<double> dualWeights(const SurfaceMesh& mesh) {
  std::vector<double> weight(mesh.n_edges(), 0.0);
  for (const auto e : mesh.edges()) {
    if (mesh.is_boundary(e)) continue;
    const double area = mesh.calc_face_area(mesh.face_handle(mesh.halfedge_handle(e, 0))) +
                        mesh.calc_face_area(mesh.face_handle(mesh.halfedge_handle(e, 1)));
    weight[e.idx()] = std::min(1.5 * mesh.calc_edge_sqr_length(e) / area, 100.0);
  }
  return weight;
}

}  // namespace trimquad
