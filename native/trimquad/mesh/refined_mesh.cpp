#include "trimquad/mesh/refined_mesh.h"

#include <algorithm>
#include <numeric>

#include "trimquad/base/error.h"
#include "trimquad/mesh/collapse_edge.h"
#include "trimquad/mesh/split_triangles.h"

namespace trimquad {
namespace {

using Origin = RefinedMesh::Origin;
using Eigen::Vector3d;

constexpr int kSweeps = 8;        ///< of `relax`
constexpr double kGood = 0.05;    ///< parts of an input triangle that need not be made larger
constexpr double kBetter = 1.01;  ///< a move must make the smallest triangle larger by this factor

VertexHandle endOf(const SurfaceMesh& mesh, EdgeHandle e, int k) {
  return mesh.to_vertex_handle(mesh.halfedge_handle(e, 1 - k));
}

/// The edge whose closure holds both, if there is one. Two vertices of one triangle are always joined.
std::optional<EdgeHandle> commonEdge(const SurfaceMesh& input, const Origin& a, const Origin& b) {
  const auto holds = [&](EdgeHandle e, const Origin& x) {
    if (const auto* other = std::get_if<EdgeHandle>(&x.element)) return *other == e;
    const auto* v = std::get_if<VertexHandle>(&x.element);
    return v && (endOf(input, e, 0) == *v || endOf(input, e, 1) == *v);
  };
  for (const auto& [x, y] : {std::pair(&a, &b), std::pair(&b, &a)})
    if (const auto* e = std::get_if<EdgeHandle>(&x->element))
      return holds(*e, *y) ? std::optional(*e) : std::nullopt;
  const auto *v = std::get_if<VertexHandle>(&a.element), *w = std::get_if<VertexHandle>(&b.element);
  if (!v || !w) return {};
  const HalfedgeHandle h = halfedgeBetween(input, *v, *w);
  return h.is_valid() ? std::optional(input.edge_handle(h)) : std::nullopt;
}

/// Weights of the edge's ends.
Vector3d weightsOnEdge(const SurfaceMesh& input, EdgeHandle e, const Origin& x) {
  if (const auto* v = std::get_if<VertexHandle>(&x.element))
    return endOf(input, e, 0) == *v ? Vector3d(1, 0, 0) : Vector3d(0, 1, 0);
  return x.weights;
}

VertexHandle add(const SurfaceMesh& input, RefinedMesh& refined, const Origin& origin) {
  refined.vertexOrigin.push_back(origin);
  return refined.mesh.add_vertex(placeInSpace(input, origin));
}

FaceHandle anyFace(const SurfaceMesh& mesh, EdgeHandle e) {
  const FaceHandle f = mesh.face_handle(mesh.halfedge_handle(e, 0));
  return f.is_valid() ? f : mesh.face_handle(mesh.halfedge_handle(e, 1));
}

double smallestTriangle(const SurfaceMesh& input, const RefinedMesh& refined, VertexHandle v,
                        const Origin& place) {
  double least = 1;
  for (const auto f : refined.mesh.vf_range(v)) {
    std::array<const Origin*, 3> corner;
    int k = 0;
    for (const auto w : refined.mesh.fv_range(f))
      corner[k++] = w == v ? &place : &refined.vertexOrigin[w.idx()];
    least = std::min(least, areaInOrigin(input, refined.originOf(f), *corner[0], *corner[1], *corner[2]));
  }
  return least;
}

/// The mean place of the neighbours that lie in the closure of the vertex's own element.
Origin amongNeighbours(const SurfaceMesh& input, const RefinedMesh& refined, VertexHandle v) {
  Origin mean = refined.vertexOrigin[v.idx()];
  Vector3d sum = Vector3d::Zero();
  int count = 0;
  for (const auto w : refined.mesh.vv_range(v)) {
    const Origin& other = refined.vertexOrigin[w.idx()];
    if (const auto* f = std::get_if<FaceHandle>(&mean.element))
      sum += barycentric(input, *f, other);
    else if (closureHolds(input, mean, other))
      sum += weightsOnEdge(input, std::get<EdgeHandle>(mean.element), other);
    else
      continue;
    ++count;
  }
  mean.weights = sum / count;
  return mean;
}

/// Moves the vertex so that its smallest triangle becomes larger, if that is small. Whether it did.
bool moveApart(const SurfaceMesh& input, RefinedMesh& refined, VertexHandle v) {
  const Origin before = refined.vertexOrigin[v.idx()];
  const double least = smallestTriangle(input, refined, v, before);
  if (least > kGood) return false;
  const Origin goal = amongNeighbours(input, refined, v);
  for (const double step : {1.0, 0.5, 0.2}) {
    Origin place = before;
    place.weights = (1 - step) * before.weights + step * goal.weights;
    const double next = smallestTriangle(input, refined, v, place);
    if (next <= 0 || next <= kBetter * least) continue;
    refined.vertexOrigin[v.idx()] = place;
    refined.mesh.set_point(v, placeInSpace(input, place));
    return true;
  }
  return false;
}

}  // namespace

RefinedMesh unrefined(const SurfaceMesh& input) {
  RefinedMesh refined;
  startFrom(input, refined);
  return refined;
}

void startFrom(const SurfaceMesh& input, RefinedMesh& refined) {
  refined.mesh = input;
  refined.vertexOrigin.clear();
  refined.vertexOrigin.reserve(input.n_vertices());
  for (int v = 0; v < int(input.n_vertices()); ++v) refined.vertexOrigin.push_back({VertexHandle(v)});
  refined.faceOrigin.resize(input.n_faces());
  std::iota(refined.faceOrigin.begin(), refined.faceOrigin.end(), 0);
}

Vector3d barycentric(const SurfaceMesh& input, FaceHandle f, const Origin& origin) {
  if (std::holds_alternative<FaceHandle>(origin.element)) return origin.weights;
  Vector3d weights = Vector3d::Zero();
  const HalfedgeHandle first = input.halfedge_handle(f), second = input.next_halfedge_handle(first);
  const auto put = [&](VertexHandle v, double weight) {
    if (input.to_vertex_handle(first) == v) return void(weights[1] = weight);
    if (input.to_vertex_handle(second) == v) return void(weights[2] = weight);
    TRIMQUAD_ASSERT(input.from_vertex_handle(first) == v);
    weights[0] = weight;
  };
  if (const auto* v = std::get_if<VertexHandle>(&origin.element)) {
    put(*v, 1);
  } else {
    const EdgeHandle e = std::get<EdgeHandle>(origin.element);
    for (const int k : {0, 1}) put(endOf(input, e, k), origin.weights[k]);
  }
  return weights;
}

Vector3d placeInSpace(const SurfaceMesh& input, const Origin& origin) {
  if (const auto* v = std::get_if<VertexHandle>(&origin.element)) return input.point(*v);
  if (const auto* e = std::get_if<EdgeHandle>(&origin.element))
    return origin.weights[0] * input.point(endOf(input, *e, 0)) +
           origin.weights[1] * input.point(endOf(input, *e, 1));
  Vector3d place = Vector3d::Zero();
  int k = 0;
  for (auto h = input.halfedge_handle(std::get<FaceHandle>(origin.element)); k < 3;
       h = input.next_halfedge_handle(h))
    place += origin.weights[k++] * input.point(input.from_vertex_handle(h));
  return place;
}

bool closureHolds(const SurfaceMesh& input, const Origin& outer, const Origin& inner) {
  if (outer.element == inner.element) return true;
  if (const auto* e = std::get_if<EdgeHandle>(&outer.element)) {
    const auto* v = std::get_if<VertexHandle>(&inner.element);
    return v && (endOf(input, *e, 0) == *v || endOf(input, *e, 1) == *v);
  }
  const auto* f = std::get_if<FaceHandle>(&outer.element);
  if (!f) return false;
  for (const auto h : input.fh_range(*f))
    if (inner.element == Origin{input.from_vertex_handle(h)}.element ||
        inner.element == Origin{input.edge_handle(h)}.element)
      return true;
  return false;
}

std::optional<EdgeHandle> edgeOrigin(const SurfaceMesh& input, const RefinedMesh& refined, EdgeHandle e) {
  return commonEdge(input, refined.vertexOrigin[endOf(refined.mesh, e, 0).idx()],
                    refined.vertexOrigin[endOf(refined.mesh, e, 1).idx()]);
}

double areaInOrigin(const SurfaceMesh& input, FaceHandle origin, const Origin& a, const Origin& b,
                    const Origin& c) {
  Eigen::Matrix3d corners;
  corners << barycentric(input, origin, a), barycentric(input, origin, b), barycentric(input, origin, c);
  return corners.determinant();
}

VertexHandle splitInMiddle(const SurfaceMesh& input, RefinedMesh& refined, EdgeHandle e) {
  const Origin &a = refined.vertexOrigin[endOf(refined.mesh, e, 0).idx()],
               &b = refined.vertexOrigin[endOf(refined.mesh, e, 1).idx()];
  Origin middle;
  if (const auto edge = commonEdge(input, a, b)) {
    middle = {*edge, 0.5 * (weightsOnEdge(input, *edge, a) + weightsOnEdge(input, *edge, b))};
  } else {
    const FaceHandle f = refined.originOf(anyFace(refined.mesh, e));
    middle = {f, 0.5 * (barycentric(input, f, a) + barycentric(input, f, b))};
  }
  const VertexHandle v = add(input, refined, middle);
  splitEdge(refined.mesh, e, v, refined.faceOrigin);
  return v;
}

VertexHandle splitInMiddle(const SurfaceMesh& input, RefinedMesh& refined, FaceHandle f) {
  const FaceHandle origin = refined.originOf(f);
  Vector3d mean = Vector3d::Zero();
  for (const auto v : refined.mesh.fv_range(f))
    mean += barycentric(input, origin, refined.vertexOrigin[v.idx()]) / 3;
  const VertexHandle v = add(input, refined, {origin, mean});
  splitFace(refined.mesh, f, v, refined.faceOrigin);
  return v;
}

std::vector<VertexHandle> compact(RefinedMesh& refined) {
  std::vector<VertexHandle> renamed;
  renamed.reserve(refined.mesh.n_vertices());
  for (int v = 0; v < int(refined.mesh.n_vertices()); ++v) renamed.emplace_back(v);
  const Renumbered renumbered = takeOutDeleted(refined.mesh);
  for (const auto& [from, to] : renumbered.vertices) {
    renamed[from] = VertexHandle(to);
    refined.vertexOrigin[to] = refined.vertexOrigin[from];
  }
  for (const auto& [from, to] : renumbered.faces) refined.faceOrigin[to] = refined.faceOrigin[from];
  refined.vertexOrigin.resize(refined.mesh.n_vertices());
  refined.faceOrigin.resize(refined.mesh.n_faces());
  return renamed;
}

void relax(const SurfaceMesh& input, RefinedMesh& refined) {
  std::vector<VertexHandle> now, next;
  for (std::size_t i = input.n_vertices(); i < refined.mesh.n_vertices(); ++i)
    now.push_back(VertexHandle(int(i)));
  for (int sweep = 0; sweep < kSweeps && !now.empty(); ++sweep) {
    next.clear();
    for (const VertexHandle v : now) {
      if (!moveApart(input, refined, v)) continue;
      // Nothing has changed for those that neither moved nor have a neighbour that did.
      next.push_back(v);
      for (const auto w : refined.mesh.vv_range(v))
        if (std::size_t(w.idx()) >= input.n_vertices()) next.push_back(w);
    }
    std::sort(next.begin(), next.end());
    next.erase(std::unique(next.begin(), next.end()), next.end());
    now.swap(next);
  }
}

Eigen::Vector2d imageInChart(const Parametrization& map, const RefinedMesh& refined, HalfedgeHandle h) {
  const FaceHandle origin = refined.originOf(refined.mesh.face_handle(h));
  const Vector3d weights =
      barycentric(map.mesh, origin, refined.vertexOrigin[refined.mesh.from_vertex_handle(h).idx()]);
  Eigen::Vector2d image = Eigen::Vector2d::Zero();
  int k = 0;
  for (auto corner = map.mesh.halfedge_handle(origin); k < 3; corner = map.mesh.next_halfedge_handle(corner))
    image += weights[k++] * map.scale.toQuads(map.from(corner));
  return image;
}

std::vector<EdgeHandle> refinedEdges(const SurfaceMesh& input, const RefinedMesh& refined,
                                     const std::vector<EdgeHandle>& edges) {
  std::vector<bool> wanted(input.n_edges(), false);
  for (const auto e : edges) wanted[e.idx()] = true;
  std::vector<EdgeHandle> pieces;
  for (const auto e : refined.mesh.edges()) {
    const auto origin = edgeOrigin(input, refined, e);
    if (origin && wanted[origin->idx()]) pieces.push_back(e);
  }
  return pieces;
}

}  // namespace trimquad
