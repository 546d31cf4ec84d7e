#include "trimquad/field/field_topology.h"

#include <cmath>
#include <optional>

#include "trimquad/base/error.h"
#include "trimquad/field/angle.h"
#include "trimquad/field/loop_turning.h"

namespace trimquad {
namespace {

/// `x` in whole quarter turns, which it must be but for rounding.
int quarters(double x) {
  const double count = x / kQuarterTurn;
  TRIMQUAD_ASSERT(std::abs(count - std::round(count)) < 0.05);
  return int(std::lround(count));
}

/// Lets no vertex have fewer than two quads, index 3 and above, as the tip of a spike would: a single quad
/// borders itself there, and index 4 is a cone without an angle. A quarter turn at a time goes to the
/// neighbour of least index, across whose edge the field then turns by more than it must.
void spreadSpikes(const SurfaceMesh& mesh, std::vector<double>& turn, CrossField& field) {
  constexpr int kMost = 2;
  for (const auto v : mesh.vertices())
    while (field.index[v.idx()] > kMost) {
      std::optional<HalfedgeHandle> best;
      for (const auto in : mesh.vih_range(v)) {
        const auto w = mesh.from_vertex_handle(in);
        if (mesh.is_boundary(w) || field.index[w.idx()] >= kMost) continue;
        if (!best || field.index[w.idx()] < field.index[mesh.from_vertex_handle(*best).idx()]) best = in;
      }
      if (!best) break;
      ++field.matching[best->idx()];
      --field.matching[mesh.opposite_halfedge_handle(*best).idx()];
      turn[best->idx()] -= kQuarterTurn;
      turn[mesh.opposite_halfedge_handle(*best).idx()] += kQuarterTurn;
      --field.index[v.idx()];
      ++field.index[mesh.from_vertex_handle(*best).idx()];
    }
}

}  // namespace

void settleTopology(const SurfaceMesh& mesh, const Transport& transport, CrossField& field) {
  std::vector<double> angle(mesh.n_faces()), turn(mesh.n_halfedges(), 0.0);
  for (const auto f : mesh.faces()) angle[f.idx()] = transport.angleOf(f, field.direction[f.idx()]);
  field.matching.assign(mesh.n_halfedges(), 0);
  for (const auto e : mesh.edges()) {
    if (mesh.is_boundary(e)) continue;
    const auto h = mesh.halfedge_handle(e, 0), o = mesh.halfedge_handle(e, 1);
    const double whole =
        angle[mesh.face_handle(o).idx()] - angle[mesh.face_handle(h).idx()] - transport.angle[h.idx()];
    field.matching[h.idx()] = int(std::lround(whole / kQuarterTurn));
    field.matching[o.idx()] = -field.matching[h.idx()];
    turn[h.idx()] = whole - kQuarterTurn * field.matching[h.idx()];
    turn[o.idx()] = -turn[h.idx()];
  }
  int total = 0;
  field.index.assign(mesh.n_vertices(), 0);
  for (const auto v : mesh.vertices()) {
    if (mesh.is_boundary(v)) continue;
    double sum = gaussCurvature(mesh, v);
    for (const auto out : mesh.voh_range(v)) sum += turn[mesh.prev_halfedge_handle(out).idx()];
    total += field.index[v.idx()] = quarters(sum);
  }
  spreadSpikes(mesh, turn, field);
  field.loopTurns.clear();
  for (const auto& loop : boundaryLoops(mesh)) {
    double sum = tangentTurn(mesh, loop);
    walkBeside(mesh, loop, [&](HalfedgeHandle h) { sum -= turn[h.idx()]; });
    field.loopTurns.push_back(quarters(sum));
    total += field.loopTurns.back();
  }
  TRIMQUAD_ASSERT(total == 4 * eulerCharacteristic(mesh));
}

}  // namespace trimquad
