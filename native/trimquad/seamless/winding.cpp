#include "trimquad/seamless/winding.h"

#include <cmath>
#include <complex>

#include "trimquad/seamless/newton.h"

namespace trimquad {

std::vector<VertexHandle> wrongCones(const SurfaceMesh& mesh, const std::vector<int>& index,
                                     const SeamBasis& basis, const Eigen::VectorXd& x) {
  const auto image = [&](HalfedgeHandle h) {
    return Eigen::Vector2d(x[basis.coordinate(basis.wedge(h), 0)], x[basis.coordinate(basis.wedge(h), 1)]);
  };
  std::vector<VertexHandle> wrong;
  for (const auto v : mesh.vertices()) {
    if (mesh.is_boundary(v)) continue;
    double angle = 0;
    for (const auto h : mesh.voh_range(v)) {
      const Eigen::Vector2d a = image(mesh.next_halfedge_handle(h)) - image(h),
                            b = image(mesh.prev_halfedge_handle(h)) - image(h);
      angle += std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
    }
    if (std::lround(angle / (M_PI / 2)) != 4 - index[v.idx()]) wrong.push_back(v);
  }
  return wrong;
}

std::vector<VertexHandle> troubled(const SurfaceMesh& mesh, const std::vector<int>& index,
                                   const SeamBasis& basis, const MapEnergy& energy,
                                   const Eigen::VectorXd& x) {
  auto vertices = wrongCones(mesh, index, basis, x);
  for (const auto f : mesh.faces())
    if (!(energy.jacobian(f.idx(), x).det() > 0))
      for (const auto v : mesh.fv_range(f)) vertices.push_back(v);
  return vertices;
}

void spreadFans(const std::vector<VertexHandle>& centers, const SurfaceMesh& mesh, const SeamGraph& seams,
                const MapTarget& target, const std::vector<int>& index, const SeamBasis& basis,
                Eigen::VectorXd& z) {
  using Complex = std::complex<double>;
  Eigen::VectorXd x = basis.basis().matrix() * z + basis.basis().offset();
  const auto image = [&](HalfedgeHandle h) {
    return Complex(x[basis.coordinate(basis.wedge(h), 0)], x[basis.coordinate(basis.wedge(h), 1)]);
  };
  for (const auto v : centers) {
    struct Spoke {
      HalfedgeHandle out;
      Complex turn;          ///< from the first spoke's chart to this one's
      double angle, length;  ///< on the surface, from the first spoke on; in quads
    };
    std::vector<Spoke> spokes;
    double angle = 0;
    Complex turn = 1, mean = 0;
    const auto start = mesh.halfedge_handle(v);
    for (auto h = start;;) {
      const auto f = mesh.face_handle(h);
      int k = 0;
      for (auto side = mesh.halfedge_handle(f); side != h; side = mesh.next_halfedge_handle(side)) ++k;
      const Eigen::Vector2d d = target[f.idx()][(k + 1) % 3] - target[f.idx()][k];
      spokes.push_back({h, turn, angle, d.norm()});
      angle += cornerAngle(mesh, h);
      const auto in = mesh.prev_halfedge_handle(h);
      if (const auto& crossing = seams.crossing[in.idx()]) {
        const int quarters = seams.rotation[crossing->branch] * (crossing->forward ? 1 : -1);
        turn *= std::polar(1.0, quarters * M_PI / 2);
      }
      h = mesh.opposite_halfedge_handle(in);
      if (h == start) break;
    }
    const double stretch = (4 - index[v.idx()]) * (M_PI / 2) / angle;
    for (const auto& spoke : spokes) {
      const auto f = mesh.face_handle(spoke.out);
      int k = 0;
      for (auto side = mesh.halfedge_handle(f); side != spoke.out; side = mesh.next_halfedge_handle(side))
        ++k;
      const Eigen::Vector2d d = target[f.idx()][(k + 1) % 3] - target[f.idx()][k];
      mean += Complex(d.x(), d.y()) / spoke.turn * std::polar(1.0, -stretch * spoke.angle);
    }
    const double direction = std::arg(mean);
    double now = 0, wanted = 0;
    for (const auto& spoke : spokes) {
      now += std::abs(image(mesh.next_halfedge_handle(spoke.out)) - image(spoke.out));
      wanted += spoke.length;
    }
    const double scale = now / wanted;
    for (const auto& spoke : spokes) {
      const Complex end =
          image(spoke.out) + std::polar(scale * spoke.length, direction + stretch * spoke.angle) * spoke.turn;
      const auto there = mesh.next_halfedge_handle(spoke.out);
      x[basis.coordinate(basis.wedge(there), 0)] = end.real();
      x[basis.coordinate(basis.wedge(there), 1)] = end.imag();
    }
  }
  z = basis.basis().restrict(x);
}

void relaxAround(const std::vector<VertexHandle>& centers, int rings, const SurfaceMesh& mesh,
                 const MapEnergy& energy, const SeamBasis& basis, Eigen::VectorXd& z) {
  std::vector<char> inside(mesh.n_vertices(), 0);
  std::vector<VertexHandle> ring = centers;
  for (const auto v : ring) inside[v.idx()] = 1;
  for (int r = 1; r < rings; ++r) {
    std::vector<VertexHandle> next;
    for (const auto v : ring)
      for (const auto w : mesh.vv_range(v))
        if (!inside[w.idx()]) {
          inside[w.idx()] = 1;
          next.push_back(w);
        }
    ring = std::move(next);
  }
  std::vector<char> released(basis.basis().variableCount(), 0);
  for (const auto h : mesh.halfedges())
    if (!mesh.is_boundary(h) && inside[mesh.from_vertex_handle(h).idx()])
      for (int axis = 0; axis < 2; ++axis) released[basis.coordinate(basis.wedge(h), axis)] = 1;
  std::vector<int> held;
  for (int i = 0; i < basis.basis().freeCount(); ++i)
    if (!released[basis.basis().freeVariable(i)]) held.push_back(i);
  const auto dirichlet = [](double I, double) { return MapDensity{I, 1, 0, 0, 0}; };
  SparseSolver solver("seamless");
  newtonStep(energy, basis, dirichlet, 0, false, solver, z, held);
}

}  // namespace trimquad
