#include "trimquad/mesh/hole_bridges.h"

#include <algorithm>
#include <numbers>
#include <string>

#include "trimquad/base/error.h"
#include "trimquad/mesh/hole_cap.h"

namespace trimquad {
namespace {

/// Least facing (see facingOf) of a hole: about 75 degrees. Lower than that of a triangle missing in a corner
/// of a box, higher than what noise makes of a tube's end.
constexpr double kHole = 0.25;

using Loop = std::vector<HalfedgeHandle>;  // boundary halfedges

double lengthOf(const SurfaceMesh& mesh, const Loop& loop) {
  double length = 0;
  for (const auto h : loop) length += mesh.calc_edge_length(h);
  return length;
}

/// How far the boundary turns to the left in total, with the surface on its left: radians, -2 pi for a hole
/// in the plane, 2 pi for an outer boundary.
double turnOf(const SurfaceMesh& mesh, const Loop& loop) {
  double turn = 0;
  for (const auto h : loop) {
    turn += std::numbers::pi;
    for (const auto out : mesh.voh_range(mesh.from_vertex_handle(h)))
      if (!mesh.is_boundary(out)) turn -= cornerAngle(mesh, out);
  }
  return turn;
}

/// Where the triangles along a loop face, against the side to which a cap of the loop would: the cosine, in
/// the mean over the loop's length. 1 for a hole in the plane, 0 for a tube's end, -1 for an outer boundary.
double facingOf(const SurfaceMesh& mesh, const Loop& loop) {
  const Eigen::Vector3d origin = mesh.point(mesh.from_vertex_handle(loop.front()));
  Eigen::Vector3d cap(0, 0, 0), around(0, 0, 0);
  for (const auto h : loop) {
    cap += (mesh.point(mesh.from_vertex_handle(h)) - origin)
               .cross(mesh.point(mesh.to_vertex_handle(h)) - origin);
    around +=
        mesh.calc_edge_length(h) * mesh.calc_face_normal(mesh.face_handle(mesh.opposite_halfedge_handle(h)));
  }
  return cap.normalized().dot(around) / lengthOf(mesh, loop);
}

/// Mean length of the edges of the triangles along a loop.
double edgeLengthAround(const SurfaceMesh& mesh, const Loop& loop) {
  double sum = 0;
  for (const auto h : loop)
    for (const auto side : mesh.fh_range(mesh.face_handle(mesh.opposite_halfedge_handle(h))))
      sum += mesh.calc_edge_length(side);
  return sum / double(3 * loop.size());
}

TriangleSoup soupOf(const SurfaceMesh& mesh) {
  TriangleSoup soup;
  for (const auto v : mesh.vertices()) soup.points.push_back(mesh.point(v));
  for (const auto f : mesh.faces()) {
    const auto h = mesh.halfedge_handle(f), next = mesh.next_halfedge_handle(h);
    soup.triangles.push_back({mesh.from_vertex_handle(h).idx(), mesh.from_vertex_handle(next).idx(),
                              mesh.to_vertex_handle(next).idx()});
  }
  return soup;
}

/// The halfedge of `to` between the images of the vertices that `h` of `from` joins; invalid where there is
/// none. \param number  by vertex of `from`: the one of `to`, invalid where there is none
HalfedgeHandle carried(const SurfaceMesh& from, const SurfaceMesh& to,
                       const std::vector<VertexHandle>& number, HalfedgeHandle h) {
  const auto a = number[from.from_vertex_handle(h).idx()], b = number[from.to_vertex_handle(h).idx()];
  return a.is_valid() && b.is_valid() ? to.find_halfedge(a, b) : HalfedgeHandle();
}

std::vector<EdgeHandle> carried(const SurfaceMesh& from, const SurfaceMesh& to,
                                const std::vector<VertexHandle>& number,
                                const std::vector<EdgeHandle>& edges) {
  std::vector<EdgeHandle> result;
  for (const auto e : edges)
    if (const auto h = carried(from, to, number, from.halfedge_handle(e, 0)); h.is_valid())
      result.push_back(to.edge_handle(h));
  std::sort(result.begin(), result.end());
  return result;
}

std::vector<VertexHandle> carried(const std::vector<VertexHandle>& number,
                                  const std::vector<VertexHandle>& vertices) {
  std::vector<VertexHandle> result;
  for (const auto v : vertices)
    if (number[v.idx()].is_valid()) result.push_back(number[v.idx()]);
  return result;
}

std::vector<std::optional<CurveId>> carriedCurves(const Region& region, const SurfaceMesh& to,
                                                  const std::vector<VertexHandle>& number) {
  std::vector<std::optional<CurveId>> curves(to.n_edges());
  for (const auto e : region.mesh.edges())
    if (const auto h = carried(region.mesh, to, number, region.mesh.halfedge_handle(e, 0)); h.is_valid())
      curves[to.edge_handle(h).idx()] = region.edgeCurve[e.idx()];
  return curves;
}

void addCap(TriangleSoup& soup, const SurfaceMesh& mesh, const Loop& loop, const Progress& progress) {
  std::vector<Eigen::Vector3d> points;
  std::vector<int> number;
  for (const auto h : loop) {
    number.push_back(mesh.from_vertex_handle(h).idx());
    points.push_back(mesh.point(mesh.from_vertex_handle(h)));
  }
  const TriangleSoup cap = holeCap(points, edgeLengthAround(mesh, loop), progress);
  for (std::size_t i = loop.size(); i < cap.points.size(); ++i) {
    number.push_back(int(soup.points.size()));
    soup.points.push_back(cap.points[i]);
  }
  for (const auto& t : cap.triangles) soup.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
}

/// The triangles of a mesh that bridge nothing, and where its vertices went.
struct Cut {
  SurfaceMesh mesh;
  std::vector<VertexHandle> number;  ///< by old vertex; invalid where it is gone
  std::vector<FaceHandle> faces;     ///< by triangle: the old one
};

Cut cutOut(const SurfaceMesh& mesh, const std::vector<bool>& bridge) {
  TRIMQUAD_ASSERT(bridge.size() == mesh.n_faces());
  std::vector<bool> kept(mesh.n_vertices(), true);
  for (const bool keep : {false, true})  // a vertex that has both stays
    for (const auto f : mesh.faces())
      if (bridge[f.idx()] != keep)
        for (const auto v : mesh.fv_range(f)) kept[v.idx()] = keep;
  const TriangleSoup all = soupOf(mesh);
  Cut cut;
  TriangleSoup soup;
  for (const auto v : mesh.vertices()) {
    cut.number.push_back(kept[v.idx()] ? VertexHandle(int(soup.points.size())) : VertexHandle());
    if (kept[v.idx()]) soup.points.push_back(all.points[v.idx()]);
  }
  for (const auto f : mesh.faces()) {
    if (bridge[f.idx()]) continue;
    auto& corners = soup.triangles.emplace_back(all.triangles[f.idx()]);
    for (int& v : corners) v = cut.number[v].idx();
    cut.faces.push_back(f);
  }
  cut.mesh = buildSurfaceMesh(soup);
  return cut;
}

}  // namespace

HoleCounts bridgeHoles(Region& region, double length, const Progress& progress) {
  const SurfaceMesh& mesh = region.mesh;
  std::vector<bool> aligned(mesh.n_edges(), false);
  for (const auto e : region.aligned) aligned[e.idx()] = true;
  HoleCounts counts;
  TriangleSoup soup = soupOf(mesh);
  for (const auto& loop : boundaryLoops(mesh)) {
    if (!(lengthOf(mesh, loop) < length)) continue;
    if (turnOf(mesh, loop) >= 0 || facingOf(mesh, loop) < kHole)
      ++counts.ends;
    else if (std::any_of(loop.begin(), loop.end(),
                         [&](HalfedgeHandle h) { return aligned[mesh.edge_handle(h).idx()]; }))
      ++counts.aligned;
    else {
      addCap(soup, mesh, loop, progress);
      ++counts.bridged;
    }
  }
  if (counts.bridged == 0) return counts;

  Region result = region;
  result.mesh = buildSurfaceMesh(soup);
  std::vector<VertexHandle> same;
  for (const auto v : mesh.vertices()) same.push_back(v);
  result.edgeCurve = carriedCurves(region, result.mesh, same);
  result.aligned = carried(mesh, result.mesh, same, region.aligned);
  result.curveParameter.resize(soup.points.size(), 0);
  result.corner.resize(soup.points.size());
  result.bridge.assign(mesh.n_faces(), false);
  result.bridge.resize(soup.triangles.size(), true);
  if (!region.inputTriangle.empty())
    result.inputTriangle.resize(soup.triangles.size(), region.inputTriangle.front());
  counts.inBridges = int(soup.triangles.size() - mesh.n_faces());
  region = std::move(result);
  return counts;
}

Region withoutBridges(const Region& region) {
  if (region.bridge.empty()) return region;
  Cut cut = cutOut(region.mesh, region.bridge);
  Region result;
  result.name = region.name;
  result.surface = region.surface;
  result.edgeCurve = carriedCurves(region, cut.mesh, cut.number);
  for (const auto v : region.mesh.vertices()) {
    if (!cut.number[v.idx()].is_valid()) continue;
    result.curveParameter.push_back(region.curveParameter[v.idx()]);
    result.corner.push_back(region.corner[v.idx()]);
  }
  if (!region.inputTriangle.empty())
    for (const auto f : cut.faces) result.inputTriangle.push_back(region.inputTriangle[f.idx()]);
  result.aligned = carried(region.mesh, cut.mesh, cut.number, region.aligned);
  result.featurePoints = carried(cut.number, region.featurePoints);
  result.mesh = std::move(cut.mesh);
  return result;
}

Parametrization withoutBridges(const Parametrization& map, const Region& region) {
  if (region.bridge.empty()) return map;
  Cut cut = cutOut(map.mesh, region.bridge);
  Parametrization result;
  result.scale = map.scale;
  result.corner.resize(cut.mesh.n_halfedges());
  for (const auto f : cut.faces)
    for (const auto h : map.mesh.fh_range(f))
      result.corner[carried(map.mesh, cut.mesh, cut.number, h).idx()] = map.from(h);
  result.aligned = carried(map.mesh, cut.mesh, cut.number, map.aligned);
  result.featurePoints = carried(cut.number, map.featurePoints);
  result.mesh = std::move(cut.mesh);
  return result;
}

}  // namespace trimquad
