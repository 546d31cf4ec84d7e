#include "trimquad/field/cross_field.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <iterator>
#include <optional>

#include "trimquad/base/error.h"
#include "trimquad/base/sparse_solver.h"
#include "trimquad/field/aligned_sectors.h"
#include "trimquad/field/angle.h"
#include "trimquad/field/angle_solve.h"
#include "trimquad/field/dual_weights.h"
#include "trimquad/field/field_topology.h"
#include "trimquad/field/transport.h"

namespace trimquad {
namespace {

using Complex = std::complex<double>;

/// Fields as one complex number per face, exp(4 i angle): the same for all four directions of a cross.
/// The energy is sum of w |z_g - exp(4 i transport) z_f|^2 over edges, plus that of the guidance; steps of
/// its gradient flow are implicit, with unit length restored after each. (Merriman-Bence-Osher; Viertel and
/// Osting 2019)
class CrossDiffusion {
 public:
  CrossDiffusion(const SurfaceMesh& mesh, const std::vector<EdgeHandle>& aligned, const Transport& transport,
                 const FieldGuidance& guidance, double guidanceReach)
      : mesh_(mesh), transport_(transport), weight_(dualWeights(mesh)) {
    const int faces = int(mesh_.n_faces());
    const double area = surfaceArea(mesh_);
    mass_.resize(faces);
    pull_.assign(faces, 0.0);
    wish_.assign(faces, Complex(0));
    for (const auto f : mesh_.faces()) {
      mass_[f.idx()] = mesh_.calc_face_area(f) / area;
      if (!(guidance.weight[f.idx()] > 0)) continue;
      pull_[f.idx()] = guidanceReach * guidanceReach * mass_[f.idx()] * guidance.weight[f.idx()];
      wish_[f.idx()] = cross(f, guidance.direction[f.idx()]);
    }
    fix(aligned);
    position_.assign(faces, -1);
    for (int f = 0; f < faces; ++f)
      if (!fixed_[f]) position_[f] = free_++;
  }

  Complex cross(FaceHandle f, const Eigen::Vector3d& direction) const {
    return std::polar(1.0, 4 * transport_.angleOf(f, direction));
  }

  /// Where a field starts from: the guidance where there is some; else the boundary's directions.
  std::vector<Complex> start() const {
    std::vector<Complex> z(mesh_.n_faces());
    double pulled = 0;
    for (const auto f : mesh_.faces()) {
      z[f.idx()] = pull_[f.idx()] * wish_[f.idx()];
      pulled += pull_[f.idx()];
    }
    for (int f = 0; f < int(fixed_.size()); ++f)
      if (fixed_[f]) z[f] = *fixed_[f], pulled += 1;
    constexpr double kFaint = 1e-3;
    if (pulled > kFaint) return z;
    for (const auto h : mesh_.halfedges())
      if (mesh_.is_boundary(h)) {
        const auto f = mesh_.opposite_face_handle(h);
        z[f.idx()] += mesh_.calc_edge_length(h) * cross(f, mesh_.calc_edge_vector(h));
        pulled = 1;
      }
    if (pulled <= kFaint) std::fill(z.begin(), z.end(), Complex(1));
    return z;
  }

  bool isFixed(FaceHandle f) const { return fixed_[f.idx()].has_value(); }
  Complex wish(FaceHandle f) const { return wish_[f.idx()]; }
  double pull(FaceHandle f) const { return pull_[f.idx()]; }

  /// For steps of `time` in units of the surface's area.
  void prepare(double time) {
    time_ = time;
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(4 * mesh_.n_edges() + 2 * mesh_.n_faces());
    const auto add = [&](int f, int g, Complex a) {  // the real form of a Hermitian matrix
      const int i = position_[f], j = position_[g];
      if (i < 0 || j < 0) return;
      entries.emplace_back(2 * i, 2 * j, a.real());
      entries.emplace_back(2 * i + 1, 2 * j + 1, a.real());
      if (f == g) return;
      entries.emplace_back(2 * i, 2 * j + 1, -a.imag());
      entries.emplace_back(2 * i + 1, 2 * j, a.imag());
    };
    for (int f = 0; f < int(mass_.size()); ++f) add(f, f, mass_[f] + time * pull_[f]);
    for (const auto e : mesh_.edges()) {
      if (mesh_.is_boundary(e)) continue;
      const auto [f, g, rotation] = across(e);
      const double w = time * weight_[e.idx()];
      add(f, f, w);
      add(g, g, w);
      add(g, f, -w * rotation);
      add(f, g, -w * std::conj(rotation));
    }
    Eigen::SparseMatrix<double> matrix(2 * free_, 2 * free_);
    matrix.setFromTriplets(entries.begin(), entries.end());
    solver_.factorize(matrix);
  }

  /// One step, not yet of unit length.
  std::vector<Complex> step(const std::vector<Complex>& z) const {
    Eigen::VectorXd rhs = Eigen::VectorXd::Zero(2 * free_);
    const auto add = [&](int f, Complex a) {
      if (position_[f] < 0) return;
      rhs[2 * position_[f]] += a.real();
      rhs[2 * position_[f] + 1] += a.imag();
    };
    for (int f = 0; f < int(mass_.size()); ++f) add(f, mass_[f] * z[f] + time_ * pull_[f] * wish_[f]);
    for (const auto e : mesh_.edges()) {
      if (mesh_.is_boundary(e)) continue;
      const auto [f, g, rotation] = across(e);
      const double w = time_ * weight_[e.idx()];
      if (fixed_[f]) add(g, w * rotation * *fixed_[f]);
      if (fixed_[g]) add(f, w * std::conj(rotation) * *fixed_[g]);
    }
    const Eigen::VectorXd x = solver_.solve(rhs);
    std::vector<Complex> next(z.size());
    for (int f = 0; f < int(next.size()); ++f)
      next[f] = fixed_[f] ? *fixed_[f] : Complex(x[2 * position_[f]], x[2 * position_[f] + 1]);
    return next;
  }

 private:
  struct Crossing {
    int f, g;
    Complex rotation;  ///< from f's frame to g's
  };
  Crossing across(EdgeHandle e) const {
    const auto h = mesh_.halfedge_handle(e, 0);
    return {mesh_.face_handle(h).idx(), mesh_.opposite_face_handle(h).idx(),
            std::polar(1.0, 4 * transport_.angle[h.idx()])};
  }

  void fix(const std::vector<EdgeHandle>& aligned) {
    fixed_.resize(mesh_.n_faces());
    for (const auto e : aligned)
      for (int side = 0; side < 2; ++side) {
        const auto h = mesh_.halfedge_handle(e, side);
        if (mesh_.is_boundary(h)) continue;
        const auto f = mesh_.face_handle(h);
        if (fixed_[f.idx()])
          throw stageError("field", "a triangle has two aligned edges; it must be split between them",
                           "triangle " + std::to_string(f.idx()), mesh_.calc_face_centroid(f));
        fixed_[f.idx()] = cross(f, mesh_.calc_edge_vector(h));
      }
  }

  const SurfaceMesh& mesh_;
  const Transport& transport_;
  std::vector<double> weight_, mass_, pull_;
  std::vector<Complex> wish_;
  std::vector<std::optional<Complex>> fixed_;
  std::vector<int> position_;  ///< by face: among the unknowns, -1 where the field is fixed
  int free_ = 0;
  double time_ = 0;
  SparseSolver solver_{"field"};
};

/// Turns the directions so that the field is smoothest while its matchings, and so its singularities, stay:
/// least squares of the turns across the edges and of the turns away from the guidance, in real angles. It
/// spreads the turn around a singularity evenly.
void relaxAngles(const SurfaceMesh& mesh, const Transport& transport, const CrossDiffusion& diffusion,
                 CrossField& field) {
  constexpr double kFixed = 1e8;  // beside weights of order 1
  auto difference = transported(mesh, transport);
  for (const auto e : mesh.edges())
    difference[e.idx()] += kQuarterTurn * field.matching[mesh.halfedge_handle(e, 0).idx()];
  std::vector<double> weight(mesh.n_faces(), 0.0);
  for (const auto f : mesh.faces()) weight[f.idx()] = diffusion.isFixed(f) ? kFixed : diffusion.pull(f);
  AngleSolve solve(mesh);
  solve.factorize(weight);
  Eigen::VectorXd rhs = solve.rightHandSide(difference);
  for (const auto f : mesh.faces()) {
    const double angle = transport.angleOf(f, field.direction[f.idx()]);
    const double off = diffusion.isFixed(f) ? 0.0 : std::arg(diffusion.wish(f)) / 4 - angle;
    rhs[f.idx()] += weight[f.idx()] * (angle + off - kQuarterTurn * std::round(off / kQuarterTurn));
  }
  const Eigen::VectorXd angle = solve.solve(rhs);
  for (const auto f : mesh.faces())
    if (!diffusion.isFixed(f)) field.direction[f.idx()] = transport.direction(f, angle[f.idx()]);
}

/// Restores unit length; where a number has vanished it stays as it was before.
void normalize(std::vector<Complex>& z, const std::vector<Complex>& before) {
  for (size_t f = 0; f < z.size(); ++f) {
    const double length = std::abs(z[f]);
    if (length > 0)
      z[f] /= length;
    else
      z[f] = std::abs(before[f]) > 0 ? before[f] / std::abs(before[f]) : Complex(1);
  }
}

/// Root mean square of the change per face.
double change(const std::vector<Complex>& z, const std::vector<Complex>& before) {
  double sum = 0;
  for (size_t f = 0; f < z.size(); ++f) sum += std::norm(z[f] - before[f]);
  return std::sqrt(sum / double(z.size()));
}

CrossField smoothField(const SurfaceMesh& mesh, const std::vector<EdgeHandle>& aligned,
                       const Transport& transport, const FieldGuidance& guidance, double guidanceReach,
                       const Progress& progress) {
  CrossDiffusion diffusion(mesh, aligned, transport, guidance, guidanceReach);
  std::vector<Complex> z = diffusion.start();
  // Long steps first, which leave only the singularities that the whole surface asks for; shorter ones then
  // bring them to their places.
  constexpr double kTimes[] = {0.1, 0.01, 0.001};
  constexpr int kSteps = 8;
  constexpr double kSettled = 0.02;
  for (const double time : kTimes) {
    diffusion.prepare(time);
    for (int step = 0; step < kSteps; ++step) {
      progress.check();
      auto next = diffusion.step(z);
      normalize(next, z);
      const double moved = change(next, z);
      z = std::move(next);
      if (moved < kSettled) break;
    }
  }
  CrossField field;
  field.aligned = aligned;
  field.direction.resize(mesh.n_faces());
  for (const auto f : mesh.faces())
    field.direction[f.idx()] = transport.direction(f, std::arg(z[f.idx()]) / 4);
  settleTopology(mesh, transport, field);
  relaxAngles(mesh, transport, diffusion, field);
  return field;
}

}  // namespace

void requireArea(const SurfaceMesh& mesh) {
  for (const auto f : mesh.faces()) {
    double longest = 0;
    for (const auto h : mesh.fh_range(f)) longest = std::max(longest, mesh.calc_edge_sqr_length(h));
    const auto h = mesh.halfedge_handle(f);
    const Eigen::Vector3d a = mesh.calc_edge_vector(h),
                          b = mesh.calc_edge_vector(mesh.next_halfedge_handle(h));
    if (!(a.cross(b).norm() > 1e-10 * longest))
      throw stageError("field",
                       "a triangle has no area; use a smaller edge length, or repair the shape there",
                       "triangle " + std::to_string(f.idx()), mesh.calc_face_centroid(f));
  }
}

CrossField crossField(const Region& region, const FieldGuidance& guidance, double guidanceReach,
                      const Progress& progress) {
  const auto& mesh = region.mesh;
  requireArea(mesh);
  const Transport transport = principalTransport(mesh);
  std::vector<EdgeHandle> aligned = region.aligned;
  for (;;) {
    CrossField field = smoothField(mesh, aligned, transport, guidance, guidanceReach, progress);
    const auto dropped = collapsingEdges(mesh, transport, field);
    if (dropped.empty()) return field;
    std::vector<EdgeHandle> rest;
    std::set_difference(aligned.begin(), aligned.end(), dropped.begin(), dropped.end(),
                        std::back_inserter(rest));
    aligned = std::move(rest);
  }
}

}  // namespace trimquad
