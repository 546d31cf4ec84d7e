#include "trimquad/gridmap/patch_disk.h"

#include <algorithm>
#include <map>

#include "trimquad/base/error.h"

namespace trimquad {

std::vector<bool> arcEdges(const EmbeddedTMesh& embedded) {
  std::vector<bool> isArc(embedded.surface.mesh.n_edges(), false);
  for (std::size_t a = 0; a < embedded.arcs.size(); ++a)
    for (const auto h : embedded.halfedges({ArcId{int(a)}, true}))
      isArc[embedded.surface.mesh.edge_handle(h).idx()] = true;
  return isArc;
}

PatchDisk patchDisk(const EmbeddedTMesh& embedded, const std::vector<bool>& arcEdges, PatchId id) {
  const auto& mesh = embedded.surface.mesh;
  PatchDisk disk;
  for (std::size_t k = 0; k < 4; ++k)
    for (const HalfArc arc : embedded[id].sides[k])
      for (const auto h : embedded.halfedges(arc)) {
        disk.rim.push_back(h);
        disk.sides.push_back({});
        disk.sides.back()[k] = true;
      }
  for (std::size_t k = 0; k < disk.rim.size(); ++k)  // a side's last vertex is the next one's first
    for (int s = 0; s < 4; ++s) {
      const auto& before = disk.sides[(k + disk.rim.size() - 1) % disk.rim.size()];
      if (before[s] && !before[(s + 1) % 4] && disk.sides[k][(s + 1) % 4]) disk.sides[k][s] = true;
    }
  std::map<HalfedgeHandle, int> number;  // by halfedge that leaves a rim vertex inside the patch
  for (std::size_t k = 0; k < disk.rim.size(); ++k)
    for (HalfedgeHandle h = disk.rim[k];;) {
      number[h] = int(k);
      const HalfedgeHandle back = mesh.prev_halfedge_handle(h);
      if (arcEdges[mesh.edge_handle(back).idx()]) break;
      h = mesh.opposite_halfedge_handle(back);
    }
  std::map<VertexHandle, int> inner;
  std::map<FaceHandle, bool> reached;
  disk.faces.push_back(mesh.face_handle(disk.rim.front()));
  reached[disk.faces.front()] = true;
  for (std::size_t i = 0; i < disk.faces.size(); ++i) {
    auto& triangle = disk.triangles.emplace_back();
    HalfedgeHandle h = mesh.halfedge_handle(disk.faces[i]);
    for (int k = 0; k < 3; ++k, h = mesh.next_halfedge_handle(h)) {
      if (const auto rim = number.find(h); rim != number.end()) {
        triangle[k] = rim->second;
      } else {
        const int next = int(disk.rim.size() + inner.size());
        triangle[k] = inner.try_emplace(mesh.from_vertex_handle(h), next).first->second;
      }
      if (arcEdges[mesh.edge_handle(h).idx()]) continue;
      const FaceHandle f = mesh.opposite_face_handle(h);
      if (reached.try_emplace(f, true).second) disk.faces.push_back(f);
    }
  }
  disk.vertexCount = disk.rim.size() + inner.size();
  return disk;
}

}  // namespace trimquad
