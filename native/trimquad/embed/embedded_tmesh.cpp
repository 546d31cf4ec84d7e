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
    for (int h = 0; h < int(mesh_.n_halfedges()); ++h)
      if (!edge_[h / 2] && mesh_.is_boundary(HalfedgeHandle(h)))
        TRIMQUAD_ASSERT(mesh_.status(EdgeHandle(h / 2)).deleted());
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

/// Walks loops of patches and the triangles inside.
class PatchWalk {
 public:
  PatchWalk(const EmbeddedTMesh& embedded, const Occupation& occupied)
      : embedded_(embedded),
        mesh_(embedded.surface.mesh),
        occupied_(occupied),
        covered_(mesh_.n_faces(), false),
        counted_(mesh_.n_vertices(), 0) {}

  void verify(PatchId id) {
    const auto rim = rimOf(id);
    inside_.clear();
    TRIMQUAD_ASSERT(!covered_[mesh_.face_handle(rim.front()).idx()]);
    reach(mesh_.face_handle(rim.front()));
    int corners = 0, onRim = 0;
    std::size_t innerSides = 0;
    const int round = 2 * id.index + 1;
    for (std::size_t k = 0; k < inside_.size(); ++k) {
      HalfedgeHandle h = mesh_.halfedge_handle(inside_[k]);
      for (int side = 0; side < 3; ++side, h = mesh_.next_halfedge_handle(h)) {
        corners += isFirstMeeting(mesh_.to_vertex_handle(h), round);
        if (occupied_[mesh_.edge_handle(h)]) continue;
        ++innerSides;
        reach(mesh_.face_handle(mesh_.opposite_halfedge_handle(h)));
      }
    }
    // A disk: its open part has the characteristic 1, and its loop is all there is of its rim.
    TRIMQUAD_ASSERT(3 * inside_.size() == innerSides + rim.size());
    for (const auto h : rim) onRim += isFirstMeeting(mesh_.to_vertex_handle(h), round + 1);
    TRIMQUAD_ASSERT(corners - onRim - int(innerSides / 2) + int(inside_.size()) == 1);
    triangles_ += inside_.size();
  }

  bool coversAll() const {
    std::size_t count = triangles_;
    for (int f = 0; f < int(mesh_.n_faces()); ++f) count += mesh_.status(FaceHandle(f)).deleted();
    return count == mesh_.n_faces();
  }

 private:
  std::vector<HalfedgeHandle> rimOf(PatchId id) const {
    std::vector<HalfedgeHandle> rim;
    const auto loop = embedded_.loop(id);
    TRIMQUAD_ASSERT(!loop.empty());
    for (std::size_t k = 0; k < loop.size(); ++k) {
      TRIMQUAD_ASSERT(embedded_.end(loop[k]) == embedded_.start(loop[(k + 1) % loop.size()]));
      for (const auto h : embedded_.halfedges(loop[k])) rim.push_back(h);
    }
    // Within the patch each piece of the loop is followed by the next one.
    for (std::size_t k = 0; k < rim.size(); ++k) {
      const HalfedgeHandle next = rim[(k + 1) % rim.size()];
      TRIMQUAD_ASSERT(mesh_.face_handle(next).is_valid());
      HalfedgeHandle back = mesh_.prev_halfedge_handle(next);
      while (!occupied_[mesh_.edge_handle(back)])
        back = mesh_.prev_halfedge_handle(mesh_.opposite_halfedge_handle(back));
      TRIMQUAD_ASSERT(back == rim[k]);
    }
    return rim;
  }

  void reach(FaceHandle f) {
    if (covered_[f.idx()]) return;
    covered_[f.idx()] = true;
    inside_.push_back(f);
  }

  bool isFirstMeeting(VertexHandle v, int round) {
    if (counted_[v.idx()] == round) return false;
    counted_[v.idx()] = round;
    return true;
  }

  const EmbeddedTMesh& embedded_;
  const SurfaceMesh& mesh_;
  const Occupation& occupied_;
  std::vector<bool> covered_;
  std::vector<int> counted_;  ///< by vertex: in which round last, from 1
  std::vector<FaceHandle> inside_;
  std::size_t triangles_ = 0;
};

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
  PatchWalk walk(embedded, occupied);
  for (std::size_t p = 0; p < embedded.patches.size(); ++p) {
    const auto& patch = embedded.patches[p];
    if (patch.removed) continue;
    for (const HalfArc h : embedded.loop(PatchId{int(p)})) ++uses[h.index()];
    for (const int k : {0, 1})
      TRIMQUAD_ASSERT(embedded.length(patch.sides[k]) == embedded.length(patch.sides[k + 2]));
    walk.verify(PatchId{int(p)});
  }
  TRIMQUAD_ASSERT(walk.coversAll());
  for (std::size_t a = 0; a < embedded.arcs.size(); ++a) {
    const auto& arc = embedded.arcs[a];
    TRIMQUAD_ASSERT(uses[2 * a] <= 1 && uses[2 * a + 1] <= 1);
    TRIMQUAD_ASSERT(uses[2 * a] + uses[2 * a + 1] == (arc.removed ? 0 : arc.border ? 1 : 2));
  }
}

}  // namespace trimquad
