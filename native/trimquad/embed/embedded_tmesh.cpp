#include "trimquad/embed/embedded_tmesh.h"

#include <algorithm>

#include "trimquad/base/error.h"
#include "trimquad/mesh/collapse_edge.h"

namespace trimquad {
namespace {

/// What the arcs occupy: every vertex and edge at most one of them, but for nodes.
class Occupation {
 public:
  explicit Occupation(const EmbeddedTMesh& embedded)
      : embedded_(embedded),
        mesh_(embedded.surface.mesh),
        vertex_(mesh_.n_vertices(), false),
        edge_(mesh_.n_edges(), false) {
    for (const auto& node : embedded.nodes)
      if (!node.removed) occupy(node.vertex);
    for (std::size_t a = 0; a < embedded.arcs.size(); ++a)
      if (!embedded.arcs[a].removed) add(ArcId{int(a)});
  }

  bool operator[](EdgeHandle e) const { return edge_[e.idx()]; }

 private:
  void occupy(VertexHandle v) {
    TRIMQUAD_ASSERT(!vertex_[v.idx()]);
    vertex_[v.idx()] = true;
  }

  void add(ArcId id) {
    const auto& arc = embedded_[id];
    TRIMQUAD_ASSERT(arc.path.size() >= 2);
    TRIMQUAD_ASSERT(arc.path.front() == embedded_[arc.from].vertex &&
                    arc.path.back() == embedded_[arc.to].vertex);
    for (std::size_t k = 1; k + 1 < arc.path.size(); ++k) occupy(arc.path[k]);
    for (const auto h : embedded_.halfedges({id, true})) {
      const EdgeHandle e = mesh_.edge_handle(h);
      TRIMQUAD_ASSERT(!edge_[e.idx()] && mesh_.is_boundary(e) == arc.border);
      edge_[e.idx()] = true;
    }
  }

  const EmbeddedTMesh& embedded_;
  const SurfaceMesh& mesh_;
  std::vector<bool> vertex_, edge_;
};

/// The halfedges of a patch's loop follow each other around one part of the surface without its arcs: each is
/// met by the next one where the mesh is turned around their vertex through that part.
void verifyLoop(const EmbeddedTMesh& embedded, const Occupation& occupied, PatchId id) {
  const SurfaceMesh& mesh = embedded.surface.mesh;
  const auto loop = embedded.loop(id);
  TRIMQUAD_ASSERT(!loop.empty());
  std::vector<HalfedgeHandle> rim;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    TRIMQUAD_ASSERT(embedded.end(loop[k]) == embedded.start(loop[(k + 1) % loop.size()]));
    for (const auto h : embedded.halfedges(loop[k])) rim.push_back(h);
  }
  for (std::size_t k = 0; k < rim.size(); ++k) {
    HalfedgeHandle back = rim[(k + 1) % rim.size()];
    do {
      TRIMQUAD_ASSERT(!mesh.is_boundary(back));
      back = mesh.opposite_halfedge_handle(mesh.prev_halfedge_handle(back));
    } while (!occupied[mesh.edge_handle(back)]);
    TRIMQUAD_ASSERT(mesh.opposite_halfedge_handle(back) == rim[k]);
  }
}

template <typename Status>
int countOfKept(const Status& status) {
  return int(std::count_if(status.begin(), status.end(), [](const auto& s) { return !s.deleted(); }));
}

template <typename Item>
int countOfKeptItems(const std::vector<Item>& items) {
  return int(std::count_if(items.begin(), items.end(), [](const Item& item) { return !item.removed; }));
}

/// V - E + F of what is not deleted.
int characteristicOf(const SurfaceMesh& mesh) {
  return countOfKept(mesh.property(mesh.vertex_status_pph()).data_vector()) -
         countOfKept(mesh.property(mesh.edge_status_pph()).data_vector()) +
         countOfKept(mesh.property(mesh.face_status_pph()).data_vector());
}

}  // namespace

EdgePath EmbeddedTMesh::path(HalfArc h) const {
  EdgePath path = (*this)[h.arc].path;
  if (!h.forward) std::reverse(path.begin(), path.end());
  return path;
}

std::vector<HalfedgeHandle> EmbeddedTMesh::halfedges(HalfArc h) const {
  const EdgePath vertices = path(h);
  std::vector<HalfedgeHandle> result;
  for (std::size_t k = 0; k + 1 < vertices.size(); ++k) {
    result.push_back(halfedgeBetween(surface.mesh, vertices[k], vertices[k + 1]));
    TRIMQUAD_ASSERT(result.back().is_valid());
  }
  return result;
}

std::vector<HalfArc> EmbeddedTMesh::loop(PatchId id) const {
  std::vector<HalfArc> all;
  for (const auto& side : (*this)[id].sides) all.insert(all.end(), side.begin(), side.end());
  return all;
}

int EmbeddedTMesh::length(const Side& side) const {
  int sum = 0;
  for (const HalfArc h : side) sum += (*this)[h.arc].length;
  return sum;
}

void verify(const EmbeddedTMesh& embedded) {
  const Occupation occupied(embedded);
  std::vector<int> uses(2 * embedded.arcs.size(), 0);
  for (std::size_t p = 0; p < embedded.patches.size(); ++p) {
    const auto& patch = embedded.patches[p];
    if (patch.removed) continue;
    for (const HalfArc h : embedded.loop(PatchId{int(p)})) ++uses[h.index()];
    for (const int k : {0, 1})
      TRIMQUAD_ASSERT(embedded.length(patch.sides[k]) == embedded.length(patch.sides[k + 2]));
    verifyLoop(embedded, occupied, PatchId{int(p)});
  }
  for (std::size_t a = 0; a < embedded.arcs.size(); ++a) {
    const auto& arc = embedded.arcs[a];
    TRIMQUAD_ASSERT(uses[2 * a] <= 1 && uses[2 * a + 1] <= 1);
    TRIMQUAD_ASSERT(uses[2 * a] + uses[2 * a + 1] == (arc.removed ? 0 : arc.border ? 1 : 2));
  }
  // Each part of the surface without its arcs now has whole loops around it, b of them, at least one. With
  // genus g its characteristic is 2 - 2g - b, which is b at most, and b only where it is a disk. They add up
  // to the surface's less that of nodes and arcs: to the number of patches only if all are disks, each a
  // patch.
  TRIMQUAD_ASSERT(countOfKeptItems(embedded.nodes) - countOfKeptItems(embedded.arcs) +
                      countOfKeptItems(embedded.patches) ==
                  characteristicOf(embedded.surface.mesh));
}

}  // namespace trimquad
