#include "trimquad/gridmap/integer_charts.h"

#include <cmath>
#include <complex>
#include <map>
#include <tuple>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

using Eigen::Vector2d;

class ChartJoin {
 public:
  ChartJoin(const SeamlessMap& seamless, const PatchMap& patches)
      : seamless_(seamless), embedded_(patches.embedded), mesh_(patches.map.mesh) {
    charts_.map = patches.map;
  }

  IntegerCharts run() && {
    refineTarget();
    joinTriangles();
    turnTowardsTarget();
    findNodes();
    findSeams();
    findAlignedSides();
    return std::move(charts_);
  }

 private:
  void refineTarget() {
    charts_.target.resize(mesh_.n_faces());
    for (const auto f : mesh_.faces()) {
      const FaceHandle origin = embedded_.surface.originOf(f);
      HalfedgeHandle h = mesh_.halfedge_handle(f);
      for (int k = 0; k < 3; ++k, h = mesh_.next_halfedge_handle(h)) {
        const Eigen::Vector3d weights = barycentric(
            seamless_.mesh, origin, embedded_.surface.vertexOrigin[mesh_.from_vertex_handle(h).idx()]);
        Vector2d& place = charts_.target[f.idx()][k];
        place.setZero();
        for (int i = 0; i < 3; ++i) place += weights[i] * seamless_.target[origin.idx()][i];
      }
    }
  }

  bool onSeam(EdgeHandle e) const {
    const auto origin = edgeOrigin(seamless_.mesh, embedded_.surface, e);
    return origin && seamless_.seams.crossing[seamless_.mesh.halfedge_handle(*origin, 0).idx()];
  }

  void move(FaceHandle f, const Transition& t) {
    for (const auto h : mesh_.fh_range(f)) charts_.map.corner[h.idx()] = t(charts_.map.corner[h.idx()]);
  }

  /// Brings the triangles into common charts, except across seams of the seamless map: so they turn against
  /// it by the same angle everywhere.
  void joinTriangles() {
    std::vector<bool> reached(mesh_.n_faces(), false);
    std::vector<FaceHandle> waiting{FaceHandle(0)};
    reached[0] = true;
    for (std::size_t i = 0; i < waiting.size(); ++i)
      for (const auto h : mesh_.fh_range(waiting[i])) {
        const auto o = mesh_.opposite_halfedge_handle(h);
        if (mesh_.is_boundary(o) || reached[mesh_.face_handle(o).idx()] || onSeam(mesh_.edge_handle(h)))
          continue;
        const FaceHandle f = mesh_.face_handle(o);
        move(f, charts_.map.transition(o));
        reached[f.idx()] = true;
        waiting.push_back(f);
      }
    TRIMQUAD_ASSERT(waiting.size() == mesh_.n_faces());
  }

  void turnTowardsTarget() {
    std::complex<double> sum = 0;
    for (const auto f : mesh_.faces()) {
      const auto& t = charts_.target[f.idx()];
      const HalfedgeHandle h = mesh_.halfedge_handle(f);
      const Vector2d a = charts_.map.scale.toQuads(charts_.map.to(h) - charts_.map.from(h)),
                     b = charts_.map.scale.toQuads(charts_.map.from(mesh_.prev_halfedge_handle(h)) -
                                                   charts_.map.from(h)),
                     c = t[1] - t[0], d = t[2] - t[0];
      Eigen::Matrix2d image, shape;
      image << a, b;
      shape << c, d;
      const double area = shape.determinant();
      const Eigen::Matrix2d adjoint{{d.y(), -d.x()}, {-c.y(), c.x()}};
      const Eigen::Matrix2d j = image * adjoint;  // Jacobian times area
      const std::complex<double> turn(j(0, 0) + j(1, 1), j(1, 0) - j(0, 1));
      if (std::abs(turn) > 0) sum += area * turn / std::abs(turn);
    }
    const int quarters = int(std::lround(-std::arg(sum) / (M_PI / 2))) & 3;
    for (const auto f : mesh_.faces()) move(f, {quarters, {}});
  }

  HalfedgeHandle cornerAt(VertexHandle v) const {
    for (const auto h : mesh_.voh_range(v))
      if (!mesh_.is_boundary(h)) return h;
    TRIMQUAD_ASSERT(!"every vertex has a triangle");
    return HalfedgeHandle();
  }

  int quads(Quanta x) const {
    TRIMQUAD_ASSERT(charts_.map.scale.isInteger(x));
    return int(x / charts_.map.scale.one());
  }
  FixedVector wholeQuads(FixedVector x) const { return {quads(x.u), quads(x.v)}; }

  /// Critical nodes are held where they are; one node is where there is none. The first lies at the origin.
  void findNodes() {
    std::vector<HalfedgeHandle> corners;
    for (const auto& node : embedded_.nodes)
      if (node.critical) corners.push_back(cornerAt(node.vertex));
    if (corners.empty()) corners.push_back(cornerAt(embedded_.nodes.front().vertex));
    const FixedVector origin = charts_.map.from(corners.front());
    for (const auto f : mesh_.faces()) move(f, {0, -origin});
    GridPoints& grid = charts_.constraints.grid;
    for (const HalfedgeHandle h : corners) {
      if (grid.count > 0) grid.relations.push_back({0, grid.count, {0, {}, wholeQuads(charts_.map.from(h))}});
      grid.places.push_back({grid.count++, h});
    }
  }

  void findSeams() {
    SeamGraph& seams = charts_.seams;
    seams.crossing.resize(mesh_.n_halfedges());
    seams.combing.assign(mesh_.n_faces(), 0);
    std::map<std::tuple<int, Quanta, Quanta>, int> branchOf;
    const auto key = [](const Transition& t) {
      return std::tuple(t.rotation, t.translation.u, t.translation.v);
    };
    for (const auto e : mesh_.edges()) {
      if (mesh_.is_boundary(e)) continue;
      const HalfedgeHandle h = mesh_.halfedge_handle(e, 0), o = mesh_.halfedge_handle(e, 1);
      const Transition there = charts_.map.transition(h), back = charts_.map.transition(o);
      if (there.isIdentity()) continue;
      const bool forward = key(there) <= key(back);
      const Transition& t = forward ? there : back;
      const auto [branch, isNew] = branchOf.try_emplace(key(t), int(seams.rotation.size()));
      if (isNew) {
        seams.rotation.push_back(t.rotation);
        charts_.constraints.translations.push_back({quads(t.translation.u), quads(t.translation.v)});
      }
      seams.crossing[h.idx()] = SeamGraph::Crossing{branch->second, forward};
      seams.crossing[o.idx()] = SeamGraph::Crossing{branch->second, !forward};
    }
  }

  void findAlignedSides() {
    for (const auto e : charts_.map.aligned)
      for (const int side : {0, 1}) {
        const HalfedgeHandle h = mesh_.halfedge_handle(e, side);
        if (mesh_.is_boundary(h)) continue;
        const FixedVector d = charts_.map.to(h) - charts_.map.from(h);
        charts_.constraints.aligned.push_back({h, d.u == 0 ? 0 : 1});
      }
  }

  const SeamlessMap& seamless_;
  const EmbeddedTMesh& embedded_;
  const SurfaceMesh& mesh_;
  IntegerCharts charts_;
};

}  // namespace

IntegerCharts integerCharts(const SeamlessMap& seamless, const PatchMap& patches) {
  return ChartJoin(seamless, patches).run();
}

}  // namespace trimquad
