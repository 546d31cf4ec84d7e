#include "trimquad/mesh/refined_mesh.h"

#include <gtest/gtest.h>

#include <random>

#include "support/sample_regions.h"
#include "trimquad/mesh/mesh_model.h"

using namespace trimquad;

namespace {

RefinedMesh splitAtRandom(const SurfaceMesh& input, int splits, unsigned seed) {
  std::mt19937 random(seed);
  RefinedMesh refined = unrefined(input);
  for (int k = 0; k < splits; ++k)
    if (random() % 2 == 0)
      splitInMiddle(input, refined, EdgeHandle(int(random() % refined.mesh.n_edges())));
    else
      splitInMiddle(input, refined, FaceHandle(int(random() % refined.mesh.n_faces())));
  return refined;
}

double smallestArea(const SurfaceMesh& input, const RefinedMesh& refined) {
  double least = 1;
  for (const auto f : refined.mesh.faces()) {
    const RefinedMesh::Origin* corner[3];
    int k = 0;
    for (const auto v : refined.mesh.fv_range(f)) corner[k++] = &refined.vertexOrigin[v.idx()];
    least = std::min(least, areaInOrigin(input, refined.originOf(f), *corner[0], *corner[1], *corner[2]));
  }
  return least;
}

}  // namespace

TEST(RefinedMesh, splitsStayInTheirTriangles) {
  const SurfaceMesh input = sample::region(sample::sheet(4, 3, sample::wavy)).mesh;
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RefinedMesh refined = splitAtRandom(input, 100, seed);
    const double before = smallestArea(input, refined);
    EXPECT_GT(before, 0);
    EXPECT_NEAR(surfaceArea(refined.mesh), surfaceArea(input), 1e-9);
    relax(input, refined);
    EXPECT_GE(smallestArea(input, refined), before);
    EXPECT_NEAR(surfaceArea(refined.mesh), surfaceArea(input), 1e-9);
  }
}

TEST(RefinedMesh, regionsKeepTheirCurvesAndConstraints) {
  MeshModelOptions options;
  options.features.alignBoundary = true;
  options.features.quadLength = 0.3;
  const Model model =
      meshModel(sample::sheet(6, 6, sample::wavy,
                              [](double s, double t) { return std::hypot(s - 0.5, t - 0.5) > 0.2; }),
                options, Progress());
  const Region& region = model.regions.front();
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const RefinedMesh mesh = splitAtRandom(region.mesh, 150, seed);
    const Region refined = refinedRegion(region, model.curves, mesh);
    double aligned = 0, before = 0;
    for (const auto e : refined.aligned) aligned += refined.mesh.calc_edge_length(e);
    for (const auto e : region.aligned) before += region.mesh.calc_edge_length(e);
    EXPECT_NEAR(aligned, before, 1e-9);
    for (const auto e : refined.mesh.edges()) {
      EXPECT_EQ(refined.edgeCurve[e.idx()].has_value(), refined.mesh.is_boundary(e));
      if (!refined.mesh.is_boundary(e)) continue;
      for (const int side : {0, 1}) {
        const auto v = refined.mesh.to_vertex_handle(refined.mesh.halfedge_handle(e, side));
        if (refined.corner[v.idx()]) continue;
        const auto& curve = *model.curves[refined.edgeCurve[e.idx()]->index].curve;
        EXPECT_NEAR((curve.point(refined.curveParameter[v.idx()]) - refined.mesh.point(v)).norm(), 0, 1e-9);
      }
    }
    ASSERT_EQ(refined.inputTriangle.size(), refined.mesh.n_faces());
    for (std::size_t f = 0; f < refined.inputTriangle.size(); ++f)
      EXPECT_EQ(refined.inputTriangle[f], region.inputTriangle[mesh.faceOrigin[f]]);
  }
}
