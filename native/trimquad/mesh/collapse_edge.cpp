#include "trimquad/mesh/collapse_edge.h"

namespace trimquad {
namespace {

void deleteEdge(SurfaceMesh& mesh, EdgeHandle e) {
  mesh.status(e).set_deleted(true);
  for (const int k : {0, 1}) mesh.status(mesh.halfedge_handle(e, k)).set_deleted(true);
}

/// A boundary vertex has the boundary halfedge that leaves it.
void preferBoundary(SurfaceMesh& mesh, VertexHandle v) {
  const HalfedgeHandle first = mesh.halfedge_handle(v);
  HalfedgeHandle h = first;
  do {
    if (mesh.is_boundary(h)) return mesh.set_halfedge_handle(v, h);
    h = mesh.next_halfedge_handle(mesh.opposite_halfedge_handle(h));
  } while (h != first);
}

void removeEdge(SurfaceMesh& mesh, HalfedgeHandle h) {
  const HalfedgeHandle o = mesh.opposite_halfedge_handle(h);
  const HalfedgeHandle next = mesh.next_halfedge_handle(h), nextOfOpposite = mesh.next_halfedge_handle(o);
  const VertexHandle stays = mesh.to_vertex_handle(h), goes = mesh.to_vertex_handle(o);
  HalfedgeHandle in = o;
  do {
    in = mesh.opposite_halfedge_handle(mesh.next_halfedge_handle(in));
    mesh.set_vertex_handle(in, stays);
  } while (in != o);
  mesh.set_next_halfedge_handle(mesh.prev_halfedge_handle(h), next);
  mesh.set_next_halfedge_handle(mesh.prev_halfedge_handle(o), nextOfOpposite);
  if (!mesh.is_boundary(h)) mesh.set_halfedge_handle(mesh.face_handle(h), next);
  if (!mesh.is_boundary(o)) mesh.set_halfedge_handle(mesh.face_handle(o), nextOfOpposite);
  if (mesh.halfedge_handle(stays) == o) mesh.set_halfedge_handle(stays, next);
  preferBoundary(mesh, stays);
  mesh.set_isolated(goes);
  mesh.status(goes).set_deleted(true);
  deleteEdge(mesh, mesh.edge_handle(h));
}

/// A face with two sides vanishes, and with it the edge of `h`; the other side takes its place.
void closeLoop(SurfaceMesh& mesh, HalfedgeHandle h) {
  const HalfedgeHandle other = mesh.next_halfedge_handle(h), o = mesh.opposite_halfedge_handle(h);
  const FaceHandle gone = mesh.face_handle(h), beyond = mesh.face_handle(o);
  mesh.set_next_halfedge_handle(other, mesh.next_halfedge_handle(o));
  mesh.set_next_halfedge_handle(mesh.prev_halfedge_handle(o), other);
  mesh.set_face_handle(other, beyond);
  mesh.set_halfedge_handle(mesh.to_vertex_handle(h), other);
  mesh.set_halfedge_handle(mesh.to_vertex_handle(other), mesh.opposite_halfedge_handle(other));
  for (const VertexHandle v : {mesh.to_vertex_handle(h), mesh.to_vertex_handle(other)})
    preferBoundary(mesh, v);
  if (beyond.is_valid() && mesh.halfedge_handle(beyond) == o) mesh.set_halfedge_handle(beyond, other);
  if (gone.is_valid()) {
    mesh.set_halfedge_handle(gone, HalfedgeHandle());
    mesh.status(gone).set_deleted(true);
  }
  deleteEdge(mesh, mesh.edge_handle(h));
}

/// Calls move(from, to) for what fills the gaps that deleted elements leave, until there are none. How many
/// are left.
template <typename Handle, typename Status, typename Mover>
std::size_t fillGaps(const Status& status, const Mover& move) {
  std::size_t end = status.size();
  for (std::size_t gap = 0; gap < end; ++gap) {
    if (!status[gap].deleted()) continue;
    while (gap < end && status[end - 1].deleted()) --end;
    if (gap < end) move(Handle(int(end - 1)), Handle(int(gap))), --end;
  }
  return end;
}

void move(SurfaceMesh& mesh, VertexHandle from, VertexHandle to) {
  mesh.set_point(to, mesh.point(from));
  mesh.status(to) = mesh.status(from);
  const HalfedgeHandle first = mesh.halfedge_handle(from);
  mesh.set_halfedge_handle(to, first);
  if (!first.is_valid()) return;
  HalfedgeHandle h = first;
  do {
    const HalfedgeHandle in = mesh.opposite_halfedge_handle(h);
    mesh.set_vertex_handle(in, to);
    h = mesh.next_halfedge_handle(in);
  } while (h != first);
}

void move(SurfaceMesh& mesh, EdgeHandle from, EdgeHandle to) {
  mesh.status(to) = mesh.status(from);
  for (const int k : {0, 1}) {
    const HalfedgeHandle before = mesh.halfedge_handle(from, k), after = mesh.halfedge_handle(to, k);
    const VertexHandle start = mesh.from_vertex_handle(before);
    mesh.status(after) = mesh.status(before);
    mesh.set_vertex_handle(after, mesh.to_vertex_handle(before));
    mesh.set_face_handle(after, mesh.face_handle(before));
    mesh.set_next_halfedge_handle(after, mesh.next_halfedge_handle(before));
    mesh.set_next_halfedge_handle(mesh.prev_halfedge_handle(before), after);
    if (mesh.halfedge_handle(start) == before) mesh.set_halfedge_handle(start, after);
    const FaceHandle f = mesh.face_handle(after);
    if (f.is_valid() && mesh.halfedge_handle(f) == before) mesh.set_halfedge_handle(f, after);
  }
}

void move(SurfaceMesh& mesh, FaceHandle from, FaceHandle to) {
  mesh.status(to) = mesh.status(from);
  const HalfedgeHandle first = mesh.halfedge_handle(from);
  mesh.set_halfedge_handle(to, first);
  HalfedgeHandle h = first;
  do {
    mesh.set_face_handle(h, to);
    h = mesh.next_halfedge_handle(h);
  } while (h != first);
}

}  // namespace

void collapseEdge(SurfaceMesh& mesh, HalfedgeHandle h) {
  const HalfedgeHandle next = mesh.next_halfedge_handle(h),
                       nextOfOpposite = mesh.next_halfedge_handle(mesh.opposite_halfedge_handle(h));
  removeEdge(mesh, h);
  const auto hasTwoSides = [&](HalfedgeHandle side) {
    return mesh.next_halfedge_handle(mesh.next_halfedge_handle(side)) == side;
  };
  if (hasTwoSides(next)) closeLoop(mesh, mesh.next_halfedge_handle(next));
  if (hasTwoSides(nextOfOpposite)) closeLoop(mesh, nextOfOpposite);
}

Renumbered takeOutDeleted(SurfaceMesh& mesh) {
  Renumbered renumbered;
  const auto moveInto = [&](std::vector<Renumbered::Move>& moves) {
    return [&](auto from, auto to) {
      move(mesh, from, to);
      moves.push_back({from.idx(), to.idx()});
    };
  };
  const std::size_t vertices = fillGaps<VertexHandle>(mesh.property(mesh.vertex_status_pph()).data_vector(),
                                                      moveInto(renumbered.vertices)),
                    edges = fillGaps<EdgeHandle>(mesh.property(mesh.edge_status_pph()).data_vector(),
                                                 moveInto(renumbered.edges)),
                    faces = fillGaps<FaceHandle>(mesh.property(mesh.face_status_pph()).data_vector(),
                                                 moveInto(renumbered.faces));
  mesh.resize(vertices, edges, faces);
  return renumbered;
}

}  // namespace trimquad
