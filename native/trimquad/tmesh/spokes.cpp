#include "trimquad/tmesh/spokes.h"

#include <algorithm>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

int slotAtVertex(const SurfaceMesh& mesh, const std::vector<IsolineLeg>& lines, const TMesh::Leg& leg) {
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const IsolineLeg& line = lines[k];
    if (line.alongEdge != leg.alongEdge) continue;
    if (leg.alongEdge
            ? mesh.edge_handle(line.side) == mesh.edge_handle(leg.side)
            : mesh.face_handle(line.side) == mesh.face_handle(leg.side) && line.direction == leg.direction)
      return int(k);
  }
  TRIMQUAD_ASSERT(!"an arc leaves its node along no iso-line");
}

/// Quarter turns from the first axis direction left of a boundary edge, in the chart of its side.
int slotAtBoundaryEdge(const Parametrization& map, HalfedgeHandle side, int direction) {
  const FixedVector along = map.to(side) - map.from(side);
  int base = 0;
  while (dot(along, rotated({1, 0}, base)) <= 0 || cross(along, rotated({1, 0}, base)) < 0) ++base;
  return (direction - base) & 3;
}

}  // namespace

std::vector<Spokes> spokesAround(const Parametrization& map, const std::vector<Seeds::Node>& nodes,
                                 const std::vector<TMesh::Arc>& arcs) {
  const auto& mesh = map.mesh;
  std::vector<Spokes> around(nodes.size());
  for (std::size_t a = 0; a < arcs.size(); ++a)
    for (const bool forward : {true, false}) {
      const NodeId node = forward ? arcs[a].from : arcs[a].to;
      around[node.index].spokes.push_back({HalfArc{ArcId{int(a)}, forward}, 0, HalfedgeHandle(), 0});
    }
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const auto& element = nodes[n].place.element;
    Spokes& here = around[n];
    here.quarters = 4;
    std::vector<IsolineLeg> lines;
    if (const auto* v = std::get_if<VertexHandle>(&element)) {
      lines = isolinesFromVertex(map, *v);
      here.quarters = mesh.is_boundary(*v) ? 0 : int(lines.size());
    }
    if (const auto* e = std::get_if<EdgeHandle>(&element); e && mesh.is_boundary(*e)) here.quarters = 0;
    for (auto& spoke : here.spokes) {
      const TMesh::Leg leg = firstLeg(arcs[spoke.arc.arc.index], spoke.arc.forward);
      spoke.corner = leg.side;
      spoke.direction = spoke.slot = leg.direction;
      if (const auto* v = std::get_if<VertexHandle>(&element)) {
        spoke.slot = slotAtVertex(mesh, lines, leg);
        while (mesh.from_vertex_handle(spoke.corner) != *v)
          spoke.corner = mesh.next_halfedge_handle(spoke.corner);
      } else if (const auto* e = std::get_if<EdgeHandle>(&element)) {
        const HalfedgeHandle side = chartSide(mesh, *e);
        if (mesh.face_handle(side) != mesh.face_handle(leg.side))
          spoke.slot = (leg.direction + map.transition(mesh.opposite_halfedge_handle(side)).rotation) & 3;
        if (mesh.is_boundary(*e)) spoke.slot = slotAtBoundaryEdge(map, side, spoke.slot);
      }
    }
    std::sort(here.spokes.begin(), here.spokes.end(),
              [](const auto& a, const auto& b) { return a.slot < b.slot; });
    for (std::size_t k = 0; k + 1 < here.spokes.size(); ++k)
      TRIMQUAD_ASSERT(here.spokes[k].slot < here.spokes[k + 1].slot);
  }
  return around;
}

}  // namespace trimquad
