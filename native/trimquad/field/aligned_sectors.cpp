#include "trimquad/field/aligned_sectors.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace trimquad {
namespace {

constexpr double kQuarter = std::numbers::pi / 2;

/// Turn of the field from the face of h to the opposite one against parallel transport.
double turnAcross(const SurfaceMesh& mesh, const Transport& transport, const CrossField& field,
                  HalfedgeHandle h) {
  const FaceHandle f = mesh.face_handle(h), g = mesh.opposite_face_handle(h);
  const double whole = transport.angleOf(g, field.direction[g.idx()]) -
                       transport.angleOf(f, field.direction[f.idx()]) - transport.angle[h.idx()] -
                       kQuarter * field.matching[h.idx()];
  return std::remainder(whole, 2 * std::numbers::pi);
}

/// How straight the edge of `out` continues another one of `spokes`: 1 for a straight line, -1 for a hairpin.
double straightness(const SurfaceMesh& mesh, HalfedgeHandle out, const std::vector<HalfedgeHandle>& spokes) {
  double best = -1;
  const Eigen::Vector3d d = mesh.calc_edge_vector(out).normalized();
  for (const auto other : spokes)
    if (other != out) best = std::max(best, -d.dot(mesh.calc_edge_vector(other).normalized()));
  return best;
}

}  // namespace

std::vector<EdgeHandle> collapsingEdges(const SurfaceMesh& mesh, const Transport& transport,
                                        const CrossField& field) {
  std::vector<char> aligned(mesh.n_edges(), 0);
  std::vector<int> count(mesh.n_vertices(), 0);
  for (const auto e : field.aligned) {
    aligned[e.idx()] = 1;
    for (int side = 0; side < 2; ++side)
      ++count[mesh.from_vertex_handle(mesh.halfedge_handle(e, side)).idx()];
  }
  std::vector<EdgeHandle> dropped;
  for (const auto v : mesh.vertices()) {
    if (count[v.idx()] < 2) continue;
    std::vector<HalfedgeHandle> spokes;
    for (const auto out : mesh.voh_range(v))
      if (aligned[mesh.edge_handle(out).idx()]) spokes.push_back(out);
    for (const auto first : spokes) {
      // Counter-clockwise to the next spoke, as long as there is surface.
      double angle = 0;
      auto out = first;
      HalfedgeHandle last;
      while (!mesh.is_boundary(out)) {
        angle += cornerAngle(mesh, out);
        const auto in = mesh.prev_halfedge_handle(out);
        const auto next = mesh.opposite_halfedge_handle(in);
        if (aligned[mesh.edge_handle(in).idx()]) {
          last = next;
          break;
        }
        if (mesh.is_boundary(next)) break;
        angle -= turnAcross(mesh, transport, field, in);
        out = next;
      }
      if (!last.is_valid() || last == first || std::lround(angle / kQuarter) >= 1) continue;
      const bool firstStays = straightness(mesh, first, spokes) >= straightness(mesh, last, spokes);
      dropped.push_back(mesh.edge_handle(firstStays ? last : first));
    }
  }
  std::sort(dropped.begin(), dropped.end());
  dropped.erase(std::unique(dropped.begin(), dropped.end()), dropped.end());
  return dropped;
}

}  // namespace trimquad
