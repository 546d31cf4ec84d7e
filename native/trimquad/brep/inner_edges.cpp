#include "trimquad/mesh/true_surface.h"

// This order: OpenCASCADE's macros must not reach the mesh headers.
#include "trimquad/brep/cad_curve.h"
#include "trimquad/brep/inner_edges.h"

namespace trimquad {
namespace {

using Triangle = WeldedMesh::Triangle;

/// Side `s` becomes the first half; returns the second. The triangles are not changed yet.
int halve(const CadModel& model, WeldedMesh& mesh, int s) {
  const auto curve = cadCurve(model.edges[*mesh.sides[s].cadEdge]);
  auto& first = mesh.sides[s];
  const double t = 0.5 * (first.first + first.last);
  const int middle = int(mesh.vertices.size());
  mesh.vertices.push_back({curve->point(t), std::nullopt, true});
  WeldedMesh::Side second = first;
  second.from = first.to = middle;
  second.first = first.last = t;
  mesh.sides.push_back(second);
  return int(mesh.sides.size()) - 1;
}

/// Cuts a triangle from the middle of its side k to the opposite corner.
void halve(WeldedMesh& mesh, int t, int k, int secondHalf) {
  const Triangle whole = mesh.triangles[t];
  const int next = (k + 1) % 3, apex = (k + 2) % 3;
  const int firstHalf = whole.side[k], middle = mesh.sides[secondHalf].from;
  const bool along = mesh.sides[firstHalf].from == whole.vertex[k];
  const int cut = int(mesh.sides.size());
  mesh.sides.push_back({middle, whole.vertex[apex], std::nullopt, 0, 0});
  const Eigen::Vector2d uv = 0.5 * (whole.uv[k] + whole.uv[next]);
  const int near = along ? firstHalf : secondHalf, far = along ? secondHalf : firstHalf;
  mesh.triangles[t] = {{whole.vertex[k], middle, whole.vertex[apex]},
                       {near, cut, whole.side[apex]},
                       {whole.uv[k], uv, whole.uv[apex]},
                       whole.face};
  mesh.triangles.push_back({{middle, whole.vertex[next], whole.vertex[apex]},
                            {far, whole.side[next], cut},
                            {uv, whole.uv[next], whole.uv[apex]},
                            whole.face});
}

}  // namespace

void divideInnerEdges(const CadModel& model, WeldedMesh& mesh, FeatureEdges& features) {
  std::vector<int> pieces(model.edges.size(), 0);
  std::vector<char> used(mesh.sides.size(), 0);
  for (const auto& triangle : mesh.triangles)
    for (const int s : triangle.side) used[s] = 1;
  for (std::size_t s = 0; s < used.size(); ++s)
    if (used[s] && mesh.sides[s].cadEdge) ++pieces[*mesh.sides[s].cadEdge];
  for (std::size_t s = 0; s < used.size(); ++s) {
    const auto edge = mesh.sides[s].cadEdge;
    if (!used[s] || !edge || !features.inner[*edge] || pieces[*edge] != 1) continue;
    const int second = halve(model, mesh, int(s));
    const auto count = mesh.triangles.size();
    for (std::size_t t = 0; t < count; ++t)
      for (int k = 0; k < 3; ++k)
        if (mesh.triangles[t].side[k] == int(s) && mesh.sides[second].from != mesh.triangles[t].vertex[k] &&
            mesh.sides[second].from != mesh.triangles[t].vertex[(k + 1) % 3]) {
          halve(mesh, int(t), k, second);
          break;
        }
  }
  features.crease.resize(mesh.sides.size(), 0);
}

}  // namespace trimquad
