#include "trimquad/mesh/working_mesh.h"

#include "support/mesh_samples.h"

namespace trimquad {
namespace {

class Plane : public TrueSurface {
 public:
  Foot closest(const Eigen::Vector3d& p) const override { return {{p.x(), p.y(), 0}, {0, 0, 1}}; }
  Foot closestFacing(const Eigen::Vector3d& p, const Eigen::Vector3d&) const override { return closest(p); }
  Curvature curvature(const Eigen::Vector3d&) const override { return {{1, 0, 0}, {0, 1, 0}, 0, 0}; }
};

Region flatRegion(int columns, int rows) {
  Region region;
  region.mesh = buildSurfaceMesh(flatSheet(columns, rows));
  region.surface = std::make_shared<Plane>();
  region.edgeCurve.resize(region.mesh.n_edges());
  for (const auto e : region.mesh.edges())
    if (region.mesh.is_boundary(e)) region.edgeCurve[e.idx()] = CurveId{0};
  region.curveParameter.resize(region.mesh.n_vertices());
  region.corner.resize(region.mesh.n_vertices());
  return region;
}

bool flipSome(WorkingMesh& work) {
  bool any = false;
  for (const auto e : work.mesh.edges()) any |= work.flipIfBetter(e);
  return any;
}

TEST(WorkingMesh, noEdgeIsPassedOverThatIsBetterFlipped) {
  const RemeshOptions options{1, 0.1};
  for (int seed = 0; seed < 20; ++seed) {
    Region region = flatRegion(8, 7);
    WorkingMesh work(region, options);
    std::mt19937 random(seed);
    const auto below = [&](std::size_t n) { return int(random() % n); };
    for (int step = 0; step < 400; ++step) {
      const EdgeHandle e(below(work.mesh.n_edges()));
      const VertexHandle v(below(work.mesh.n_vertices()));
      const FaceHandle f(below(work.mesh.n_faces()));
      const int kind = below(5);
      if (kind == 0 && !work.mesh.status(e).deleted() && !work.mesh.is_boundary(e)) {
        work.splitInner(e, true);
      } else if (kind == 1 && !work.mesh.status(e).deleted() && work.mesh.is_boundary(e)) {
        const auto h = work.mesh.halfedge_handle(e, 0);
        work.splitBoundary(e, 0, work.mesh.calc_edge_midpoint(h));
      } else if (kind == 2 && !work.mesh.status(e).deleted()) {
        const auto h = work.mesh.halfedge_handle(e, 0);
        const auto after = work.qualityAfterCollapse(h);
        if (!work.isHeld(work.mesh.from_vertex_handle(h)) && after && *after > 0.05) work.collapse(h);
      } else if (kind == 3 && !work.mesh.status(v).deleted() && !work.isHeld(v)) {
        work.smooth(v);
      } else if (kind == 4 && !work.mesh.status(f).deleted()) {
        work.splitFace(f);
      }
      if (step % 7 == 0) flipSome(work);
    }
    for (int pass = 0; pass < 100 && flipSome(work); ++pass) {
    }
    EXPECT_FALSE(flipSome(work));
    work.finish(region);
    WorkingMesh fresh(region, options);
    EXPECT_FALSE(flipSome(fresh)) << "seed " << seed;
  }
}

}  // namespace
}  // namespace trimquad
