#include "trimquad/embed/embedded_tmesh.h"

#include <algorithm>

#include "trimquad/base/error.h"

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
    for (const auto e : mesh_.edges()) TRIMQUAD_ASSERT(edge_[e.idx()] || !mesh_.is_boundary(e));
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

/// Walks the patch's loop and the triangles inside. Returns how many these are.
std::size_t verifyPatch(const EmbeddedTMesh& embedded, PatchId id, const Occupation& occupied,
                        std::vector<bool>& covered) {
  const auto& mesh = embedded.surface.mesh;
  std::vector<HalfedgeHandle> rim;
  const auto loop = embedded.loop(id);
  TRIMQUAD_ASSERT(!loop.empty());
  for (std::size_t k = 0; k < loop.size(); ++k) {
    TRIMQUAD_ASSERT(embedded.end(loop[k]) == embedded.start(loop[(k + 1) % loop.size()]));
    for (const auto h : embedded.halfedges(loop[k])) rim.push_back(h);
  }
  // Within the patch each piece of the loop is followed by the next one.
  for (std::size_t k = 0; k < rim.size(); ++k) {
    const HalfedgeHandle next = rim[(k + 1) % rim.size()];
    TRIMQUAD_ASSERT(mesh.face_handle(next).is_valid());
    HalfedgeHandle back = mesh.prev_halfedge_handle(next);
    while (!occupied[mesh.edge_handle(back)])
      back = mesh.prev_halfedge_handle(mesh.opposite_halfedge_handle(back));
    TRIMQUAD_ASSERT(back == rim[k]);
  }
  std::vector<FaceHandle> inside;
  const auto reach = [&](FaceHandle f) {
    if (covered[f.idx()]) return;
    covered[f.idx()] = true;
    inside.push_back(f);
  };
  TRIMQUAD_ASSERT(!covered[mesh.face_handle(rim.front()).idx()]);
  reach(mesh.face_handle(rim.front()));
  int innerSides = 0;
  std::vector<VertexHandle> corners;
  for (std::size_t k = 0; k < inside.size(); ++k)
    for (const auto h : mesh.fh_range(inside[k])) {
      corners.push_back(mesh.to_vertex_handle(h));
      if (occupied[mesh.edge_handle(h)]) continue;
      ++innerSides;
      reach(mesh.opposite_face_handle(h));
    }
  // A disk: its open part has the characteristic 1, and its loop is all there is of its rim.
  TRIMQUAD_ASSERT(3 * inside.size() == std::size_t(innerSides) + rim.size());
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  std::vector<VertexHandle> onRim;
  for (const auto h : rim) onRim.push_back(mesh.to_vertex_handle(h));
  std::sort(onRim.begin(), onRim.end());
  onRim.erase(std::unique(onRim.begin(), onRim.end()), onRim.end());
  TRIMQUAD_ASSERT(int(corners.size() - onRim.size()) - innerSides / 2 + int(inside.size()) == 1);
  return inside.size();
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
    result.push_back(surface.mesh.find_halfedge(vertices[k], vertices[k + 1]));
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
  std::vector<bool> covered(embedded.surface.mesh.n_faces(), false);
  std::size_t triangles = 0;
  for (std::size_t p = 0; p < embedded.patches.size(); ++p) {
    const auto& patch = embedded.patches[p];
    if (patch.removed) continue;
    for (const HalfArc h : embedded.loop(PatchId{int(p)})) ++uses[h.index()];
    for (const int k : {0, 1})
      TRIMQUAD_ASSERT(embedded.length(patch.sides[k]) == embedded.length(patch.sides[k + 2]));
    triangles += verifyPatch(embedded, PatchId{int(p)}, occupied, covered);
  }
  TRIMQUAD_ASSERT(triangles == embedded.surface.mesh.n_faces());
  for (std::size_t a = 0; a < embedded.arcs.size(); ++a) {
    const auto& arc = embedded.arcs[a];
    TRIMQUAD_ASSERT(uses[2 * a] <= 1 && uses[2 * a + 1] <= 1);
    TRIMQUAD_ASSERT(uses[2 * a] + uses[2 * a + 1] == (arc.removed ? 0 : arc.border ? 1 : 2));
  }
}

}  // namespace trimquad
