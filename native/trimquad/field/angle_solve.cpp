#include "trimquad/field/angle_solve.h"

#include <cmath>

#include "trimquad/field/dual_weights.h"

namespace trimquad {
namespace {

/// Calls visit(e, f, g) for every interior edge, f and g the faces of its halfedges 0 and 1.
template <typename Visit>
void forInteriorEdges(const SurfaceMesh& mesh, const Visit& visit) {
  for (const auto e : mesh.edges())
    if (!mesh.is_boundary(e))
      visit(e.idx(), mesh.face_handle(mesh.halfedge_handle(e, 0)).idx(),
            mesh.face_handle(mesh.halfedge_handle(e, 1)).idx());
}

}  // namespace

AngleSolve::AngleSolve(const SurfaceMesh& mesh) : mesh_(mesh), weight_(dualWeights(mesh)) {}

void AngleSolve::factorize(const std::vector<double>& faceWeight) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(4 * mesh_.n_edges() + mesh_.n_faces() + 1);
  double sum = 0;
  for (const double w : faceWeight) sum += w;
  for (const auto f : mesh_.faces()) entries.emplace_back(f.idx(), f.idx(), faceWeight[f.idx()]);
  if (sum == 0) entries.emplace_back(0, 0, 1.0);
  forInteriorEdges(mesh_, [&](int e, int f, int g) {
    entries.emplace_back(f, f, weight_[e]);
    entries.emplace_back(g, g, weight_[e]);
    entries.emplace_back(f, g, -weight_[e]);
    entries.emplace_back(g, f, -weight_[e]);
  });
  Eigen::SparseMatrix<double> matrix(Eigen::Index(mesh_.n_faces()), Eigen::Index(mesh_.n_faces()));
  matrix.setFromTriplets(entries.begin(), entries.end());
  solver_.factorize(matrix);
}

Eigen::VectorXd AngleSolve::rightHandSide(const std::vector<double>& difference) const {
  Eigen::VectorXd rhs = Eigen::VectorXd::Zero(Eigen::Index(mesh_.n_faces()));
  forInteriorEdges(mesh_, [&](int e, int f, int g) {
    rhs[f] -= weight_[e] * difference[e];
    rhs[g] += weight_[e] * difference[e];
  });
  return rhs;
}

Eigen::VectorXd AngleSolve::residual(const Eigen::VectorXd& angle,
                                     const std::vector<double>& difference) const {
  Eigen::VectorXd r = Eigen::VectorXd::Zero(Eigen::Index(mesh_.n_edges()));
  forInteriorEdges(mesh_, [&](int e, int f, int g) {
    r[e] = std::sqrt(weight_[e]) * (angle[g] - angle[f] - difference[e]);
  });
  return r;
}

std::vector<double> transported(const SurfaceMesh& mesh, const Transport& transport) {
  std::vector<double> difference(mesh.n_edges(), 0.0);
  for (const auto e : mesh.edges()) difference[e.idx()] = transport.angle[mesh.halfedge_handle(e, 0).idx()];
  return difference;
}

}  // namespace trimquad
