#include "trimquad/seamless/conformal_scale.h"

#include <cmath>
#include <numbers>

#include "trimquad/base/sparse_solver.h"
#include "trimquad/field/dual_weights.h"
#include "trimquad/field/transport.h"

namespace trimquad {

std::vector<double> conformalScale(const SurfaceMesh& mesh, const CrossField& field) {
  const Transport transport = principalTransport(mesh);
  const std::vector<double> lengthOverWidth = dualWeights(mesh);
  const Eigen::Index vertices = Eigen::Index(mesh.n_vertices());
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd rhs = Eigen::VectorXd::Zero(vertices);
  for (const auto e : mesh.edges()) {
    if (mesh.is_boundary(e)) continue;
    // Counter-clockwise around its start the edge is crossed from the triangle on its right.
    const auto out = mesh.halfedge_handle(e, 0), h = mesh.halfedge_handle(e, 1);
    const auto f = mesh.face_handle(h), g = mesh.face_handle(out);
    const double turn = std::remainder(
        transport.angleOf(g, field.direction[g.idx()]) - transport.angleOf(f, field.direction[f.idx()]) -
            transport.angle[h.idx()] - field.matching[h.idx()] * std::numbers::pi / 2,
        2 * std::numbers::pi);
    const int v = mesh.from_vertex_handle(out).idx(), w = mesh.to_vertex_handle(out).idx();
    const double conductance = 1 / lengthOverWidth[e.idx()];
    entries.emplace_back(v, v, conductance);
    entries.emplace_back(w, w, conductance);
    entries.emplace_back(v, w, -conductance);
    entries.emplace_back(w, v, -conductance);
    rhs[v] += turn;
    rhs[w] -= turn;
  }
  for (Eigen::Index v = 0; v < vertices; ++v) entries.emplace_back(v, v, 1e-9);  // the constant is free
  Eigen::SparseMatrix<double> matrix(vertices, vertices);
  matrix.setFromTriplets(entries.begin(), entries.end());
  SparseSolver solver("seamless");
  solver.factorize(matrix);
  const Eigen::VectorXd logarithm = solver.solve(rhs);
  std::vector<double> scale(mesh.n_faces());
  double area = 0, scaled = 0;
  for (const auto f : mesh.faces()) {
    double sum = 0;
    for (const auto v : mesh.fv_range(f)) sum += logarithm[v.idx()];
    scale[f.idx()] = std::exp(sum / 3);
    area += mesh.calc_face_area(f);
    scaled += mesh.calc_face_area(f) * scale[f.idx()] * scale[f.idx()];
  }
  for (double& s : scale) s /= std::sqrt(scaled / area);
  return scale;
}

}  // namespace trimquad
