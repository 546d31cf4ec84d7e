#include "trimquad/brep/welded_mesh.h"

#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <map>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kAngularDeflection = 0.35;  // radians between neighbouring triangles
constexpr int kSplitRounds = 8;

/// Joins the triangulations of the faces one after the other.
class Welder {
 public:
  explicit Welder(const CadModel& model)
      : model_(model), nodesOfEdge_(model.edges.size()), sidesOfEdge_(model.edges.size()) {
    for (int v = 0; v < int(model.vertices.size()); ++v)
      mesh_.vertices.push_back({model.vertices[v], v, true});
  }

  void add(int faceIndex);
  WeldedMesh take() { return std::move(mesh_); }

 private:
  /// The CAD edge's vertices of the mesh, made by the first face that has the edge.
  const std::vector<int>& nodesOf(int edge, const Poly_PolygonOnTriangulation& polygon,
                                  const std::vector<Vector3d>& points, const CadFace& face);

  const CadModel& model_;
  WeldedMesh mesh_;
  std::vector<std::vector<int>> nodesOfEdge_, sidesOfEdge_;
};

const std::vector<int>& Welder::nodesOf(int edge, const Poly_PolygonOnTriangulation& polygon,
                                        const std::vector<Vector3d>& points, const CadFace& face) {
  const CadEdge& cad = model_.edges[edge];
  const int count = polygon.NbNodes();
  auto& nodes = nodesOfEdge_[edge];
  if (!nodes.empty()) {
    if (int(nodes.size()) != count)
      throw inputError("tessellate", "two faces divide their common edge differently; repair the shape",
                       cad.name);
    return nodes;
  }
  if (count < 2 || (!cad.degenerate && !polygon.HasParameters()))
    throw inputError("tessellate", "the edge cannot be divided; repair the shape",
                     cad.name + " of " + face.name);
  nodes.push_back(cad.start);
  for (int k = 1; k + 1 < count; ++k) {
    if (cad.degenerate) {
      nodes.push_back(cad.start);
      continue;
    }
    nodes.push_back(int(mesh_.vertices.size()));
    mesh_.vertices.push_back({points[polygon.Node(k + 1) - 1], std::nullopt, true});
  }
  nodes.push_back(cad.end);
  for (int k = 0; k + 1 < count; ++k) {
    sidesOfEdge_[edge].push_back(int(mesh_.sides.size()));
    const double first = cad.degenerate ? 0 : polygon.Parameter(k + 1);
    const double last = cad.degenerate ? 0 : polygon.Parameter(k + 2);
    mesh_.sides.push_back({nodes[k], nodes[k + 1], edge, first, last});
  }
  return nodes;
}

void Welder::add(int faceIndex) {
  const CadFace& face = model_.faces[faceIndex];
  TopLoc_Location location;
  const Handle(Poly_Triangulation) triangulation = BRep_Tool::Triangulation(face.face, location);
  if (triangulation.IsNull() || triangulation->NbTriangles() == 0 || !triangulation->HasUVNodes())
    throw inputError("tessellate",
                     "the face cannot be triangulated: its wires are open, cross or enclose nothing; "
                     "repair the shape",
                     face.name);
  std::vector<Vector3d> points;
  for (int n = 1; n <= triangulation->NbNodes(); ++n) {
    const gp_Pnt p = triangulation->Node(n).Transformed(location.Transformation());
    points.emplace_back(p.X(), p.Y(), p.Z());
  }

  std::vector<int> vertex(points.size(), -1);
  std::map<std::array<int, 2>, int> sideOfNodes;
  for (TopExp_Explorer e(face.face, TopAbs_EDGE); e.More(); e.Next()) {
    const int edge = model_.edgeIndex(e.Current());
    const Handle(Poly_PolygonOnTriangulation) polygon =
        BRep_Tool::PolygonOnTriangulation(TopoDS::Edge(e.Current()), triangulation, location);
    if (polygon.IsNull())
      throw inputError("tessellate",
                       "the face cannot be triangulated along one of its edges; repair the shape",
                       model_.edges[edge].name + " of " + face.name);
    const auto& nodes = nodesOf(edge, *polygon, points, face);
    for (int k = 0; k < int(nodes.size()); ++k) {
      vertex[polygon->Node(k + 1) - 1] = nodes[k];
      if (k == 0) continue;
      const auto [a, b] = std::minmax({polygon->Node(k), polygon->Node(k + 1)});
      sideOfNodes.emplace(std::array<int, 2>{a, b}, sidesOfEdge_[edge][k - 1]);
    }
  }
  for (size_t n = 0; n < points.size(); ++n) {
    if (vertex[n] >= 0) continue;
    vertex[n] = int(mesh_.vertices.size());
    mesh_.vertices.push_back({points[n], std::nullopt, false});
  }

  for (int t = 1; t <= triangulation->NbTriangles(); ++t) {
    std::array<int, 3> node{};
    triangulation->Triangle(t).Get(node[0], node[1], node[2]);
    auto& triangle = mesh_.triangles.emplace_back();
    triangle.face = faceIndex;
    for (int k = 0; k < 3; ++k) {
      const gp_Pnt2d uv = triangulation->UVNode(node[k]);
      triangle.vertex[k] = vertex[node[k] - 1];
      triangle.uv[k] = {uv.X(), uv.Y()};
      const auto [a, b] = std::minmax({node[k], node[(k + 1) % 3]});
      const auto [entry, isNew] = sideOfNodes.emplace(std::array<int, 2>{a, b}, int(mesh_.sides.size()));
      if (isNew) mesh_.sides.push_back({vertex[a - 1], vertex[b - 1], std::nullopt, 0, 0});
      triangle.side[k] = entry->second;
    }
  }
}

/// Takes out the triangles at degenerate edges (poles), whose base is a point, and joins their two legs.
void closePoles(const CadModel& model, WeldedMesh& mesh) {
  std::vector<int> same(mesh.sides.size());
  for (size_t s = 0; s < same.size(); ++s) same[s] = int(s);
  const auto root = [&](int s) {
    while (same[s] != s) s = same[s] = same[same[s]];
    return s;
  };
  std::vector<WeldedMesh::Triangle> kept;
  for (const auto& triangle : mesh.triangles) {
    int base = -1;
    for (int k = 0; k < 3; ++k)
      if (const auto& edge = mesh.sides[triangle.side[k]].cadEdge; edge && model.edges[*edge].degenerate)
        base = k;
    if (base < 0) {
      kept.push_back(triangle);
      continue;
    }
    // A leg on a CAD edge stays.
    const int a = root(triangle.side[(base + 1) % 3]), b = root(triangle.side[(base + 2) % 3]);
    if (mesh.sides[b].cadEdge)
      same[a] = b;
    else
      same[b] = a;
  }
  for (auto& triangle : kept)
    for (int& s : triangle.side) s = root(s);
  mesh.triangles = std::move(kept);
}

class Splitter {
 public:
  Splitter(const CadModel& model, WeldedMesh& mesh) : model_(model), mesh_(mesh) {}

  /// Splits the marked sides in their middles.
  void split(const std::vector<char>& marked) {
    middle_.assign(mesh_.sides.size(), -1);
    halves_.assign(mesh_.sides.size(), {});
    visits_.assign(mesh_.sides.size(), 0);
    const size_t count = mesh_.triangles.size();
    for (size_t t = 0; t < count; ++t) {
      const WeldedMesh::Triangle triangle = mesh_.triangles[t];
      for (int k = 0; k < 3; ++k)
        if (marked[triangle.side[k]] && middle_[triangle.side[k]] < 0) divide(triangle, k);
      divideTriangle(t);
    }
  }

 private:
  Vector3d surfacePoint(int face, const Vector2d& uv) const {
    const gp_Pnt p = model_.faces[face].surface->Value(uv.x(), uv.y());
    return {p.X(), p.Y(), p.Z()};
  }

  void divide(const WeldedMesh::Triangle& triangle, int k) {
    const int index = triangle.side[k];
    const WeldedMesh::Side side = mesh_.sides[index];
    const Vector2d uv = 0.5 * (triangle.uv[k] + triangle.uv[(k + 1) % 3]);
    const double t = 0.5 * (side.first + side.last);
    middle_[index] = int(mesh_.vertices.size());
    mesh_.vertices.push_back({surfacePoint(triangle.face, uv), std::nullopt, side.cadEdge.has_value()});
    halves_[index] = {int(mesh_.sides.size()), int(mesh_.sides.size()) + 1};
    mesh_.sides.push_back({side.from, middle_[index], side.cadEdge, side.first, t});
    mesh_.sides.push_back({middle_[index], side.to, side.cadEdge, t, side.last});
  }

  /// Cuts one corner after the other off at a divided side.
  void divideTriangle(size_t t) {
    for (int k = 0; k < 3; ++k) {
      WeldedMesh::Triangle whole = mesh_.triangles[t];
      const int index = whole.side[k];
      if (index >= int(middle_.size()) || middle_[index] < 0) continue;
      const int middle = middle_[index], next = (k + 1) % 3, last = (k + 2) % 3;
      const bool along = runsAlong(whole, k);
      const auto [head, tail] =
          along ? halves_[index] : std::array<int, 2>{halves_[index][1], halves_[index][0]};
      const int cut = int(mesh_.sides.size());
      mesh_.sides.push_back({middle, whole.vertex[last], std::nullopt, 0, 0});
      const Vector2d uv = 0.5 * (whole.uv[k] + whole.uv[next]);
      WeldedMesh::Triangle a = whole, b = whole;
      a.vertex[next] = middle, a.uv[next] = uv, a.side[k] = head, a.side[next] = cut;
      b.vertex[k] = middle, b.uv[k] = uv, b.side[k] = tail, b.side[last] = cut;
      mesh_.triangles[t] = a;
      const size_t other = mesh_.triangles.size();
      mesh_.triangles.push_back(b);
      divideTriangle(t);
      divideTriangle(other);
      return;
    }
  }

  /// Whether the triangle's side k runs from the side's `from` to its `to`. A side around a closed face can
  /// start and end in one vertex; its two triangles belong to one face then and run through it in opposite
  /// directions.
  bool runsAlong(const WeldedMesh::Triangle& triangle, int k) {
    const int index = triangle.side[k];
    const auto& side = mesh_.sides[index];
    return side.from == side.to ? visits_[index]++ == 0 : side.from == triangle.vertex[k];
  }

  const CadModel& model_;
  WeldedMesh& mesh_;
  std::vector<int> middle_, visits_;
  std::vector<std::array<int, 2>> halves_;
};

/// Splits sides until no two join the same vertices, and no inner side joins two points of CAD edges: what is
/// left is a simplicial complex on whose edges the mesh structure can be built.
void makeSimplicial(const CadModel& model, WeldedMesh& mesh) {
  for (int round = 0; round < kSplitRounds; ++round) {
    std::vector<char> used(mesh.sides.size(), 0), marked(mesh.sides.size(), 0);
    for (const auto& triangle : mesh.triangles)
      for (const int s : triangle.side) used[s] = 1;
    std::vector<std::array<int, 3>> pairs;
    bool any = false;
    for (int s = 0; s < int(mesh.sides.size()); ++s) {
      if (!used[s]) continue;
      const auto& side = mesh.sides[s];
      pairs.push_back({std::min(side.from, side.to), std::max(side.from, side.to), s});
      const bool chord = !side.cadEdge && mesh.vertices[side.from].onEdge && mesh.vertices[side.to].onEdge;
      if (chord || side.from == side.to) marked[s] = 1, any = true;
    }
    std::sort(pairs.begin(), pairs.end());
    for (size_t i = 1; i < pairs.size(); ++i)
      if (pairs[i][0] == pairs[i - 1][0] && pairs[i][1] == pairs[i - 1][1])
        marked[pairs[i][2]] = marked[pairs[i - 1][2]] = 1, any = true;
    if (!any) return;
    Splitter(model, mesh).split(marked);
  }
  throw inputError("tessellate", "the faces touch themselves so closely that they cannot be triangulated");
}

}  // namespace

WeldedMesh weldedMesh(const CadModel& model, double deflection) {
  BRepMesh_IncrementalMesh(model.shape, deflection, false, kAngularDeflection, false);
  Welder welder(model);
  for (int f = 0; f < int(model.faces.size()); ++f) welder.add(f);
  WeldedMesh mesh = welder.take();
  closePoles(model, mesh);
  makeSimplicial(model, mesh);
  return mesh;
}

}  // namespace trimquad
