#include "trimquad/field/transport.h"

#include <cmath>
#include <numbers>
#include <queue>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

constexpr double kFullTurn = 2 * std::numbers::pi;

}  // namespace

double gaussCurvature(const SurfaceMesh& mesh, VertexHandle v) {
  double sum = kFullTurn;
  for (const auto h : mesh.voh_range(v)) sum -= cornerAngle(mesh, h);
  return sum;
}

double Transport::angleOf(FaceHandle f, const Eigen::Vector3d& d) const {
  return std::atan2(d.dot(axisV[f.idx()]), d.dot(axisU[f.idx()]));
}

Eigen::Vector3d Transport::direction(FaceHandle f, double a) const {
  return std::cos(a) * axisU[f.idx()] + std::sin(a) * axisV[f.idx()];
}

Transport principalTransport(const SurfaceMesh& mesh) {
  Transport result;
  result.axisU.resize(mesh.n_faces());
  result.axisV.resize(mesh.n_faces());
  result.angle.assign(mesh.n_halfedges(), 0.0);
  for (const auto f : mesh.faces()) {
    const auto h = mesh.halfedge_handle(f);
    const Eigen::Vector3d a = mesh.point(mesh.from_vertex_handle(h)),
                          b = mesh.point(mesh.to_vertex_handle(h)),
                          c = mesh.point(mesh.to_vertex_handle(mesh.next_halfedge_handle(h)));
    const Eigen::Vector3d u = (b - a).normalized(), n = (b - a).cross(c - a).normalized();
    result.axisU[f.idx()] = u;
    result.axisV[f.idx()] = n.cross(u);
  }
  for (const auto e : mesh.edges()) {
    if (mesh.is_boundary(e)) continue;
    const auto h = mesh.halfedge_handle(e, 0), o = mesh.halfedge_handle(e, 1);
    const Eigen::Vector3d d = mesh.point(mesh.to_vertex_handle(h)) - mesh.point(mesh.from_vertex_handle(h));
    const double a = result.angleOf(mesh.face_handle(o), d) - result.angleOf(mesh.face_handle(h), d);
    result.angle[h.idx()] = std::remainder(a, kFullTurn);
    result.angle[o.idx()] = -result.angle[h.idx()];
  }
  return result;
}

Transport liftedTransport(const SurfaceMesh& mesh) {
  Transport result = principalTransport(mesh);

  // Spanning tree of triangles: its angles keep their principal value.
  std::vector<char> reached(mesh.n_faces(), 0), inTree(mesh.n_edges(), 0);
  std::queue<FaceHandle> faces;
  if (mesh.n_faces() > 0) {
    faces.push(FaceHandle(0));
    reached[0] = 1;
  }
  while (!faces.empty()) {
    const auto f = faces.front();
    faces.pop();
    for (const auto h : mesh.fh_range(f)) {
      const auto g = mesh.opposite_face_handle(h);
      if (!g.is_valid() || reached[g.idx()]) continue;
      reached[g.idx()] = 1;
      inTree[mesh.edge_handle(h).idx()] = 1;
      faces.push(g);
    }
  }
  // The other interior edges join the interior vertices to the boundary without a circuit through interior
  // vertices alone (genus 0): a vertex with one unsettled edge left settles it.
  std::vector<int> unsettled(mesh.n_vertices(), 0);
  std::vector<char> settled(mesh.n_edges(), 0);
  for (const auto e : mesh.edges()) {
    settled[e.idx()] = inTree[e.idx()] || mesh.is_boundary(e);
    if (settled[e.idx()]) continue;
    ++unsettled[mesh.to_vertex_handle(mesh.halfedge_handle(e, 0)).idx()];
    ++unsettled[mesh.to_vertex_handle(mesh.halfedge_handle(e, 1)).idx()];
  }
  std::queue<VertexHandle> leaves;
  for (const auto v : mesh.vertices())
    if (!mesh.is_boundary(v) && unsettled[v.idx()] == 1) leaves.push(v);
  const auto settle = [&](HalfedgeHandle h) {
    settled[mesh.edge_handle(h).idx()] = 1;
    for (const auto w : {mesh.from_vertex_handle(h), mesh.to_vertex_handle(h)})
      if (--unsettled[w.idx()] == 1 && !mesh.is_boundary(w)) leaves.push(w);
  };
  // A chain of edges between two boundary loops has no leaf: the turn of the field around the loops is open
  // there, so any one of its edges may keep its principal value.
  auto open = mesh.edges_begin();
  for (;;) {
    if (leaves.empty()) {
      while (open != mesh.edges_end() && settled[open->idx()]) ++open;
      if (open == mesh.edges_end()) break;
      settle(mesh.halfedge_handle(*open, 0));
      continue;
    }
    const auto v = leaves.front();
    leaves.pop();
    if (unsettled[v.idx()] != 1) continue;
    // Counter-clockwise around v, faces change across the incoming halfedge of each face; the sum must be K.
    double sum = 0;
    HalfedgeHandle last;
    for (const auto out : mesh.voh_range(v)) {
      const auto in =
          mesh.prev_halfedge_handle(out);  // the face left of `out` ends counter-clockwise at `in`
      sum += result.angle[in.idx()];
      if (!settled[mesh.edge_handle(in).idx()]) last = in;
    }
    const double turns = std::round((gaussCurvature(mesh, v) - sum) / kFullTurn);
    result.angle[last.idx()] += turns * kFullTurn;
    result.angle[mesh.opposite_halfedge_handle(last).idx()] = -result.angle[last.idx()];
    settle(last);
  }
  for (const auto v : mesh.vertices()) {
    if (mesh.is_boundary(v)) continue;
    double sum = 0;
    for (const auto out : mesh.voh_range(v)) sum += result.angle[mesh.prev_halfedge_handle(out).idx()];
    TRIMQUAD_ASSERT(std::abs(sum - gaussCurvature(mesh, v)) < 1e-4);
  }
  return result;
}

}  // namespace trimquad
