#include <cmath>

#include "trimquad/embed/refined_mesh.h"

namespace trimquad {
namespace {

/// Parameters of the start and end of an edge's halfedge 0 on the curve that the edge lies on.
std::array<double, 2> parametersOfEnds(const Region& region, EdgeHandle e, const TrueCurve& curve) {
  const VertexHandle ends[] = {region.mesh.from_vertex_handle(region.mesh.halfedge_handle(e, 0)),
                               region.mesh.to_vertex_handle(region.mesh.halfedge_handle(e, 0))};
  const auto isCorner = [&](int k) { return region.corner[ends[k].idx()].has_value(); };
  const auto parameter = [&](int k) { return region.curveParameter[ends[k].idx()]; };
  const double first = curve.first(), last = curve.last();
  if (isCorner(0) && isCorner(1)) {
    const auto offStart = [&](int k) { return (curve.point(first) - region.mesh.point(ends[k])).norm(); };
    return offStart(0) <= offStart(1) ? std::array{first, last} : std::array{last, first};
  }
  // A corner is the end of the curve that is nearer to the vertex beside it.
  const auto nearerEnd = [&](double t) { return std::abs(t - first) <= std::abs(last - t) ? first : last; };
  return {isCorner(0) ? nearerEnd(parameter(1)) : parameter(0),
          isCorner(1) ? nearerEnd(parameter(0)) : parameter(1)};
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
  result.aligned = refinedEdges(region.mesh, refined, region.aligned);
  return result;
}

}  // namespace trimquad
