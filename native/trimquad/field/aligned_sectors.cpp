#include "trimquad/field/aligned_sectors.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "trimquad/field/angle.h"

namespace trimquad {
namespace {

/// Turn of the field from the face of h to the opposite one against parallel transport.
double turnAcross(const SurfaceMesh& mesh, const Transport& transport, const CrossField& field,
                  HalfedgeHandle h) {
  const FaceHandle f = mesh.face_handle(h), g = mesh.opposite_face_handle(h);
  const double whole = transport.angleOf(g, field.direction[g.idx()]) -
                       transport.angleOf(f, field.direction[f.idx()]) - transport.angle[h.idx()] -
                       kQuarterTurn * field.matching[h.idx()];
  return std::remainder(whole, 2 * std::numbers::pi);
}

/// The third corner of the triangle left of `h`; if that triangle is a part of one that was split at a point
/// inside, the third corner of the whole.
VertexHandle apexOf(const SurfaceMesh& mesh, HalfedgeHandle h) {
  const VertexHandle apex = mesh.to_vertex_handle(mesh.next_halfedge_handle(h));
  if (mesh.is_boundary(apex) || mesh.valence(apex) != 3) return apex;
  for (const auto w : mesh.vv_range(apex))
    if (w != mesh.from_vertex_handle(h) && w != mesh.to_vertex_handle(h)) return w;
  return apex;
}

/// The edges to drop, where `dropped` alone would not do: an edge whose ends another two edges still join,
/// all three around one triangle, would stay as a chord, with its triangle's corners in a line. It stays
/// aligned, and the two others go.
std::vector<EdgeHandle> withoutChords(const SurfaceMesh& mesh, const std::vector<char>& aligned,
                                      const std::vector<EdgeHandle>& dropped) {
  std::vector<char> remains = aligned;
  for (const auto e : dropped) remains[e.idx()] = 0;
  for (const auto e : dropped)
    for (int side = 0; side < 2; ++side) {
      const auto h = mesh.halfedge_handle(e, side);
      if (mesh.is_boundary(h)) continue;
      const auto apex = apexOf(mesh, h);
      const auto toFirst = mesh.find_halfedge(apex, mesh.from_vertex_handle(h)),
                 toSecond = mesh.find_halfedge(apex, mesh.to_vertex_handle(h));
      if (!toFirst.is_valid() || !toSecond.is_valid()) continue;
      const auto first = mesh.edge_handle(toFirst), second = mesh.edge_handle(toSecond);
      if (!remains[first.idx()] || !remains[second.idx()]) continue;
      remains[e.idx()] = 1;
      remains[first.idx()] = remains[second.idx()] = 0;
      break;
    }
  std::vector<EdgeHandle> result;
  for (const auto e : mesh.edges())
    if (aligned[e.idx()] && !remains[e.idx()]) result.push_back(e);
  return result;
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
      if (!last.is_valid() || last == first || std::lround(angle / kQuarterTurn) >= 1) continue;
      const bool firstStays = straightness(mesh, first, spokes) >= straightness(mesh, last, spokes);
      dropped.push_back(mesh.edge_handle(firstStays ? last : first));
    }
  }
  std::sort(dropped.begin(), dropped.end());
  return withoutChords(mesh, aligned, dropped);
}

}  // namespace trimquad
