#include "trimquad/mesh/working_mesh.h"

#include <algorithm>
#include <cmath>

namespace trimquad {
namespace {

using Eigen::Vector3d;

constexpr int kGradationSweeps = 3;
/// Least wanted length on a boundary that is an edge of the surface within the tolerance, by its own edges:
/// much shorter ones beside them would make slivers.
constexpr double kBesideRidge = 0.5;
constexpr double kSmoothing = 0.8;    ///< share of the way to the neighbours' middle
constexpr double kOffMiddle = 0.35;   ///< how far a split may be off the edge's middle, in edge lengths
constexpr double kSplitLoss = 0.2;    ///< least share of the old quality that a split must leave
constexpr double kSameSheet = 0.3;    ///< cosine up to which normals count as those of one sheet
constexpr double kGoodEnough = 0.25;  ///< quality down to which smoothing may go

}  // namespace

WorkingMesh::WorkingMesh(const Region& region, const RemeshOptions& options)
    : mesh(region.mesh),
      parameter(region.curveParameter),
      corner(region.corner),
      fixed(mesh.n_vertices(), 0),
      pinned(mesh.n_vertices(), 0),
      edgeCurve(region.edgeCurve),
      surface_(*region.surface),
      options_(options),
      settled_(mesh.n_edges(), 0) {
  for (const auto v : mesh.vertices()) {
    normal.push_back(normalOnSheet(v));
    measureCurvature(mesh.point(v));
    if (corner[v.idx()]) fixed[v.idx()] = 1;
  }
  for (const auto v : region.featurePoints) {
    pinned[v.idx()] = 1;
    if (mesh.is_boundary(v)) fixed[v.idx()] = 1;
  }
  size = curvatureSize;
}

Vector3d WorkingMesh::normalOnSheet(VertexHandle v) const {
  Vector3d facing = Vector3d::Zero();
  for (auto f = mesh.cvf_begin(v); f.is_valid(); ++f) facing += mesh.calc_face_normal(*f);
  const Vector3d nearest = surface_.closest(mesh.point(v)).normal;
  if (nearest.dot(facing) > kSameSheet * facing.norm()) return nearest;
  // Two sheets meet here; the middles of the triangles tell them apart.
  Vector3d sum = Vector3d::Zero();
  for (auto f = mesh.cvf_begin(v); f.is_valid(); ++f)
    sum += surface_.closest(mesh.calc_face_centroid(*f)).normal;
  return sum.norm() > 0 ? Vector3d(sum.normalized()) : nearest;
}

double WorkingMesh::quality(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& normal) {
  const double sides = (b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm();
  return sides > 0 ? 2 * std::sqrt(3.0) * (b - a).cross(c - a).dot(normal) / sides : 0;
}

double WorkingMesh::quality(FaceHandle f) const {
  const auto h = mesh.halfedge_handle(f);
  const auto a = mesh.from_vertex_handle(h), b = mesh.to_vertex_handle(h),
             c = mesh.to_vertex_handle(mesh.next_halfedge_handle(h));
  return quality(mesh.point(a), mesh.point(b), mesh.point(c),
                 (normal[a.idx()] + normal[b.idx()] + normal[c.idx()]).normalized());
}

double WorkingMesh::worstAround(VertexHandle v, const Vector3d& point, VertexHandle except) const {
  double worst = 1;
  for (auto h = mesh.cvoh_begin(v); h.is_valid(); ++h) {
    if (mesh.is_boundary(*h)) continue;
    const auto b = mesh.to_vertex_handle(*h), c = mesh.to_vertex_handle(mesh.next_halfedge_handle(*h));
    if (b == except || c == except) continue;
    worst = std::min(worst, quality(point, mesh.point(b), mesh.point(c),
                                    (normal[v.idx()] + normal[b.idx()] + normal[c.idx()]).normalized()));
  }
  return worst;
}

double WorkingMesh::wantedLength(EdgeHandle e) const {
  const auto h = mesh.halfedge_handle(e, 0);
  return 0.5 * (size[mesh.from_vertex_handle(h).idx()] + size[mesh.to_vertex_handle(h).idx()]);
}

bool WorkingMesh::isChord(EdgeHandle e) const {
  const auto h = mesh.halfedge_handle(e, 0);
  return !mesh.is_boundary(e) && mesh.is_boundary(mesh.from_vertex_handle(h)) &&
         mesh.is_boundary(mesh.to_vertex_handle(h));
}

void WorkingMesh::measureCurvature(const Vector3d& point) {
  const double k = largestCurvature(surface_, point);
  curvatureSize.push_back(lengthByCurvature(k, options_));
  onRidge.push_back(isSharp(k, options_));
}

VertexHandle WorkingMesh::addVertex(const Vector3d& point, const Vector3d& surfaceNormal) {
  normal.push_back(surfaceNormal);
  measureCurvature(point);
  size.push_back(curvatureSize.back());
  parameter.push_back(0);
  corner.emplace_back();
  fixed.push_back(0);
  pinned.push_back(0);
  return mesh.add_vertex(point);
}

void WorkingMesh::disturb(VertexHandle v) {
  settled_.resize(mesh.n_edges(), 0);
  for (auto h = mesh.cvoh_begin(v); h.is_valid(); ++h) {
    settled_[mesh.edge_handle(*h).idx()] = 0;
    settled_[mesh.edge_handle(mesh.next_halfedge_handle(*h)).idx()] = 0;
  }
}

double WorkingMesh::splitQuality(HalfedgeHandle h, const Vector3d& point, const Vector3d& pointNormal) const {
  double worst = 1;
  for (const auto g : {h, mesh.opposite_halfedge_handle(h)}) {
    const auto a = mesh.from_vertex_handle(g), b = mesh.to_vertex_handle(g),
               c = mesh.to_vertex_handle(mesh.next_halfedge_handle(g));
    const Vector3d base = pointNormal + normal[c.idx()];
    worst =
        std::min({worst, quality(mesh.point(a), point, mesh.point(c), (base + normal[a.idx()]).normalized()),
                  quality(point, mesh.point(b), mesh.point(c), (base + normal[b.idx()]).normalized())});
  }
  return worst;
}

bool WorkingMesh::splitInner(EdgeHandle e, bool always) {
  const auto h = mesh.halfedge_handle(e, 0);
  const auto a = mesh.from_vertex_handle(h), b = mesh.to_vertex_handle(h);
  const Vector3d middle = 0.5 * (mesh.point(a) + mesh.point(b));
  const auto foot = surface_.closestFacing(middle, normal[a.idx()] + normal[b.idx()]);
  const Vector3d away = foot.point - middle;
  const Vector3d facing = normal[a.idx()] + normal[b.idx()];
  const bool between = away.norm() <= kOffMiddle * length(e) && foot.normal.dot(facing) > 0 &&
                       splitQuality(h, foot.point, foot.normal) >
                           kSplitLoss * std::min(quality(mesh.face_handle(h)),
                                                 quality(mesh.face_handle(mesh.opposite_halfedge_handle(h))));
  if (!between && !always) return false;
  const double inherited = 0.5 * (size[a.idx()] + size[b.idx()]);
  const auto v = addVertex(foot.point, foot.normal);
  size[v.idx()] = std::min(size[v.idx()], inherited);
  mesh.split(e, v);
  edgeCurve.resize(mesh.n_edges());
  disturb(v);
  return true;
}

VertexHandle WorkingMesh::splitBoundary(EdgeHandle e, double t, const Vector3d& point) {
  const auto h = mesh.halfedge_handle(e, 0);
  const auto a = mesh.from_vertex_handle(h), b = mesh.to_vertex_handle(h);
  const auto curve = edgeCurve[e.idx()];
  const Vector3d facing = (normal[a.idx()] + normal[b.idx()]).normalized();
  const Vector3d nearest = surface_.closest(point).normal;
  const auto v = addVertex(point, nearest.dot(facing) > kSameSheet ? nearest : facing);
  parameter[v.idx()] = t;
  mesh.split(e, v);
  edgeCurve.resize(mesh.n_edges());
  disturb(v);
  for (const auto end : {a, b}) edgeCurve[mesh.edge_handle(mesh.find_halfedge(v, end)).idx()] = curve;
  return v;
}

void WorkingMesh::splitFace(FaceHandle f) {
  const auto foot = surface_.closestFacing(mesh.calc_face_centroid(f), mesh.calc_face_normal(f));
  const auto v = addVertex(foot.point, foot.normal);
  mesh.split(f, v);
  edgeCurve.resize(mesh.n_edges());
  disturb(v);
}

std::optional<double> WorkingMesh::qualityAfterCollapse(HalfedgeHandle h) const {
  // OpenMesh's test needs vertex tags and therefore a mesh that it may change.
  if (!const_cast<SurfaceMesh&>(mesh).is_collapse_ok(h)) return {};
  return worstAround(mesh.from_vertex_handle(h), mesh.point(mesh.to_vertex_handle(h)),
                     mesh.to_vertex_handle(h));
}

void WorkingMesh::collapse(HalfedgeHandle h) {
  const auto v = mesh.from_vertex_handle(h), to = mesh.to_vertex_handle(h);
  // A boundary vertex vanishes between its neighbour and `to`; their new edge lies on the same curve.
  VertexHandle neighbour;
  std::optional<CurveId> curve;
  if (mesh.is_boundary(v)) {
    const auto out = mesh.halfedge_handle(v);
    const auto in = mesh.prev_halfedge_handle(out);
    neighbour = mesh.to_vertex_handle(out) == to ? mesh.from_vertex_handle(in) : mesh.to_vertex_handle(out);
    curve = edgeCurve[mesh.edge_handle(h).idx()];
  }
  mesh.collapse(h);
  disturb(to);
  if (curve) edgeCurve[mesh.edge_handle(mesh.find_halfedge(neighbour, to)).idx()] = curve;
}

bool WorkingMesh::isBetterFlipped(EdgeHandle e) const {
  if (mesh.is_boundary(e)) return false;
  const auto h = mesh.halfedge_handle(e, 0), o = mesh.halfedge_handle(e, 1);
  const auto a = mesh.from_vertex_handle(h), b = mesh.to_vertex_handle(h);
  const auto c = mesh.to_vertex_handle(mesh.next_halfedge_handle(h)),
             d = mesh.to_vertex_handle(mesh.next_halfedge_handle(o));
  if (mesh.is_boundary(c) && mesh.is_boundary(d)) return false;
  const double before = std::min(quality(mesh.face_handle(h)), quality(mesh.face_handle(o)));
  if (before > 0.99) return false;
  const Vector3d base = normal[c.idx()] + normal[d.idx()];
  const double after =
      std::min(quality(mesh.point(c), mesh.point(d), mesh.point(b), (base + normal[b.idx()]).normalized()),
               quality(mesh.point(d), mesh.point(c), mesh.point(a), (base + normal[a.idx()]).normalized()));
  return after > before + 1e-6;
}

bool WorkingMesh::flipIfBetter(EdgeHandle e) {
  if (settled_[e.idx()]) return false;
  if (!isBetterFlipped(e)) {
    settled_[e.idx()] = 1;
    return false;
  }
  // Whether it can be depends on triangles farther away.
  if (!mesh.is_flip_ok(e)) return false;
  mesh.flip(e);
  for (const int side : {0, 1}) {
    const auto h = mesh.halfedge_handle(e, side);
    settled_[mesh.edge_handle(mesh.next_halfedge_handle(h)).idx()] = 0;
    settled_[mesh.edge_handle(mesh.prev_halfedge_handle(h)).idx()] = 0;
  }
  return true;
}

void WorkingMesh::smooth(VertexHandle v) {
  Vector3d middle = Vector3d::Zero();
  double count = 0;
  for (auto n = mesh.cvv_begin(v); n.is_valid(); ++n) middle += mesh.point(*n), ++count;
  const Vector3d& n = normal[v.idx()];
  Vector3d step = kSmoothing * (middle / count - mesh.point(v));
  step -= n.dot(step) * n;
  const auto foot = surface_.closestFacing(mesh.point(v) + step, n);
  if (foot.normal.dot(n) <= 0 || (foot.point - mesh.point(v)).norm() > 2 * step.norm()) return;
  const double before = worstAround(v, mesh.point(v)), after = worstAround(v, foot.point);
  if (after < before && after < kGoodEnough) return;
  mesh.set_point(v, foot.point);
  normal[v.idx()] = foot.normal;
  disturb(v);
}

void WorkingMesh::updateSizes() {
  size = curvatureSize;
  std::vector<double> sum(size.size(), 0), least(size.size(), 0);
  for (const auto e : mesh.edges()) {
    if (!mesh.is_boundary(e)) continue;
    for (const int side : {0, 1})
      sum[mesh.to_vertex_handle(mesh.halfedge_handle(e, side)).idx()] += 0.5 * length(e);
  }
  for (size_t v = 0; v < size.size(); ++v) {
    if (!(sum[v] > 0)) continue;
    size[v] = std::min(size[v], std::max(sum[v], kShortestEdge * options_.edgeLength));
    if (onRidge[v]) least[v] = kBesideRidge * sum[v];
  }
  for (int sweep = 0; sweep < kGradationSweeps; ++sweep)
    for (const auto e : mesh.edges()) {
      const auto h = mesh.halfedge_handle(e, 0);
      double &a = least[mesh.from_vertex_handle(h).idx()], &b = least[mesh.to_vertex_handle(h).idx()];
      const double fall = kGradation * length(e);
      a = std::max(a, b - fall);
      b = std::max(b, a - fall);
    }
  for (size_t v = 0; v < size.size(); ++v) size[v] = std::max(size[v], least[v]);
  for (int sweep = 0; sweep < kGradationSweeps; ++sweep)
    for (const auto e : mesh.edges()) {
      const auto h = mesh.halfedge_handle(e, 0);
      double &a = size[mesh.from_vertex_handle(h).idx()], &b = size[mesh.to_vertex_handle(h).idx()];
      const double growth = kGradation * length(e);
      a = std::min(a, b + growth);
      b = std::min(b, a + growth);
    }
}

void WorkingMesh::finish(Region& region) const {
  TriangleSoup soup;
  std::vector<int> number(mesh.n_vertices(), -1);
  region.curveParameter.clear();
  region.corner.clear();
  region.featurePoints.clear();
  for (const auto v : mesh.vertices()) {
    number[v.idx()] = int(soup.points.size());
    soup.points.push_back(mesh.point(v));
    region.curveParameter.push_back(parameter[v.idx()]);
    region.corner.push_back(corner[v.idx()]);
    if (pinned[v.idx()]) region.featurePoints.emplace_back(number[v.idx()]);
  }
  for (const auto f : mesh.faces()) {
    const auto h = mesh.halfedge_handle(f);
    soup.triangles.push_back({number[mesh.from_vertex_handle(h).idx()],
                              number[mesh.to_vertex_handle(h).idx()],
                              number[mesh.to_vertex_handle(mesh.next_halfedge_handle(h)).idx()]});
  }
  region.mesh = buildSurfaceMesh(soup);
  region.edgeCurve.assign(region.mesh.n_edges(), std::nullopt);
  for (const auto e : mesh.edges()) {
    if (!mesh.is_boundary(e)) continue;
    const auto h = mesh.halfedge_handle(e, 0);
    const VertexHandle a(number[mesh.from_vertex_handle(h).idx()]), b(number[mesh.to_vertex_handle(h).idx()]);
    region.edgeCurve[region.mesh.edge_handle(region.mesh.find_halfedge(a, b)).idx()] = edgeCurve[e.idx()];
  }
}

}  // namespace trimquad
