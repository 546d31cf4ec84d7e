#include "trimquad/seamless/local_refinement.h"

#include <algorithm>

namespace trimquad {
namespace {

/// By halfedge of the refined mesh: the halfedge of the input that it is a part of, if any.
std::vector<std::optional<HalfedgeHandle>> origins(const SurfaceMesh& mesh, const RefinedMesh& refined) {
  std::vector<std::optional<HalfedgeHandle>> origin(refined.mesh.n_halfedges());
  for (const auto e : refined.mesh.edges()) {
    const auto whole = edgeOrigin(mesh, refined, e);
    if (!whole) continue;
    for (int side = 0; side < 2; ++side) {
      const auto part = refined.mesh.halfedge_handle(e, side);
      const auto h = mesh.halfedge_handle(*whole, 0), o = mesh.halfedge_handle(*whole, 1);
      const bool border = refined.mesh.is_boundary(part);
      const bool forward = border ? mesh.is_boundary(h)
                                  : mesh.face_handle(h) == refined.originOf(refined.mesh.face_handle(part));
      origin[part.idx()] = forward ? h : o;
    }
  }
  return origin;
}

}  // namespace

std::vector<FaceHandle> within(const SurfaceMesh& mesh, const std::vector<FaceHandle>& triangles, int rings) {
  std::vector<char> inside(mesh.n_faces(), 0);
  std::vector<FaceHandle> all = triangles;
  for (const auto f : triangles) inside[f.idx()] = 1;
  size_t first = 0;
  for (int ring = 0; ring < rings; ++ring) {
    const size_t last = all.size();
    for (; first < last; ++first)
      for (const auto v : mesh.fv_range(all[first]))
        for (const auto f : mesh.vf_range(v))
          if (!inside[f.idx()]) inside[f.idx()] = 1, all.push_back(f);
  }
  std::sort(all.begin(), all.end());
  return all;
}

std::vector<EdgeHandle> edgesOf(const SurfaceMesh& mesh, const std::vector<FaceHandle>& triangles) {
  std::vector<EdgeHandle> edges;
  for (const auto f : triangles)
    for (const auto e : mesh.fe_range(f)) edges.push_back(e);
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  std::stable_sort(edges.begin(), edges.end(), [&](EdgeHandle a, EdgeHandle b) {
    return mesh.calc_edge_sqr_length(a) > mesh.calc_edge_sqr_length(b);
  });
  return edges;
}

CrossField refinedField(const SurfaceMesh& mesh, const RefinedMesh& refined, const CrossField& field) {
  CrossField result;
  for (const int f : refined.faceOrigin) result.direction.push_back(field.direction[f]);
  result.matching.assign(refined.mesh.n_halfedges(), 0);
  const auto origin = origins(mesh, refined);
  for (size_t h = 0; h < origin.size(); ++h)
    if (origin[h]) result.matching[h] = field.matching[origin[h]->idx()];
  result.index = field.index;
  result.index.resize(refined.mesh.n_vertices(), 0);
  result.loopTurns = field.loopTurns;
  result.aligned = refinedEdges(mesh, refined, field.aligned);
  result.follow = field.follow;
  return result;
}

FieldGuidance refinedGuidance(const RefinedMesh& refined, const FieldGuidance& guidance) {
  FieldGuidance result;
  for (const int f : refined.faceOrigin) {
    result.direction.push_back(guidance.direction[f]);
    result.weight.push_back(guidance.weight[f]);
  }
  return result;
}

}  // namespace trimquad
