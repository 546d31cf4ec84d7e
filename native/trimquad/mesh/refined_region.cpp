#include <limits>

#include "trimquad/mesh/refined_mesh.h"

namespace trimquad {
namespace {

/// Parameters of the start and end of an edge's halfedge 0 on the curve that the edge lies on.
std::array<double, 2> parametersOfEnds(const Region& region, EdgeHandle e, const TrueCurve& curve) {
  const VertexHandle ends[] = {region.mesh.from_vertex_handle(region.mesh.halfedge_handle(e, 0)),
                               region.mesh.to_vertex_handle(region.mesh.halfedge_handle(e, 0))};
  // A corner is the start or the end of the curve, or both: the edge's middle tells.
  std::array<std::vector<double>, 2> choices;
  for (const int k : {0, 1})
    if (region.corner[ends[k].idx()])
      choices[k] = {curve.first(), curve.last()};
    else
      choices[k] = {region.curveParameter[ends[k].idx()]};
  const Eigen::Vector3d a = region.mesh.point(ends[0]), b = region.mesh.point(ends[1]);
  std::array<double, 2> best{};
  double least = std::numeric_limits<double>::infinity();
  for (const double s : choices[0])
    for (const double t : choices[1]) {
      const double off = (curve.point(s) - a).norm() + (curve.point(t) - b).norm() +
                         (curve.point(0.5 * (s + t)) - 0.5 * (a + b)).norm();
      if (off < least) least = off, best = {s, t};
    }
  return best;
}

}  // namespace

Region refinedRegion(const Region& region, const std::vector<ModelCurve>& curves,
                     const RefinedMesh& refined) {
  Region result = region;
  result.mesh = refined.mesh;
  result.edgeCurve.assign(refined.mesh.n_edges(), {});
  result.curveParameter.resize(refined.mesh.n_vertices(), 0);
  result.corner.resize(refined.mesh.n_vertices());
  for (const auto e : refined.mesh.edges())
    if (const auto origin = edgeOrigin(region.mesh, refined, e))
      result.edgeCurve[e.idx()] = region.edgeCurve[origin->idx()];
  for (std::size_t i = region.mesh.n_vertices(); i < refined.mesh.n_vertices(); ++i) {
    const auto* e = std::get_if<EdgeHandle>(&refined.vertexOrigin[i].element);
    if (!e || !region.edgeCurve[e->idx()]) continue;
    const TrueCurve& curve = *curves[region.edgeCurve[e->idx()]->index].curve;
    const auto ends = parametersOfEnds(region, *e, curve);
    const auto& weights = refined.vertexOrigin[i].weights;
    const double t = weights[0] * ends[0] + weights[1] * ends[1];
    result.curveParameter[i] = t;
    result.mesh.set_point(VertexHandle(int(i)), curve.point(t));
  }
  if (!region.inputTriangle.empty()) {
    result.inputTriangle.clear();
    for (const int origin : refined.faceOrigin) result.inputTriangle.push_back(region.inputTriangle[origin]);
  }
  if (!region.bridge.empty()) {
    result.bridge.clear();
    for (const int origin : refined.faceOrigin) result.bridge.push_back(region.bridge[origin]);
  }
  result.aligned = refinedEdges(region.mesh, refined, region.aligned);
  return result;
}

}  // namespace trimquad
