#include "trimquad/embed/embed.h"
#include "support/rounds.h"

#include "tmesh/random_surfaces.h"
#include "tmesh/tmesh_checks.h"

using namespace trimquad;
using namespace trimquad::samples;

namespace {

GridMap randomMap(unsigned seed) {
  std::mt19937 random(seed);
  GridMap map = random() % 2 == 0 ? randomDomain(random) : randomSingularSurface(random);
  if (random() % 2 == 0) alignSome(map, 1 + random() % 4, random);
  if (random() % 3 == 0) markSome(map, 2 + random() % 20, random);
  // From quads much larger than the surface to much smaller ones: the same map in another unit.
  map.scale.bits += int(random() % 9) - 4;
  return map;
}

/// Every new triangle lies in its input triangle, and together they fill it.
void expectSubdivision(const SurfaceMesh& input, const RefinedMesh& refined) {
  std::vector<double> area(input.n_faces(), 0);
  for (const auto f : refined.mesh.faces()) {
    const RefinedMesh::Origin* corner[3];
    int k = 0;
    for (const auto v : refined.mesh.fv_range(f)) corner[k++] = &refined.vertexOrigin[v.idx()];
    const double part = areaInOrigin(input, refined.originOf(f), *corner[0], *corner[1], *corner[2]);
    EXPECT_GT(part, 0);
    area[refined.faceOrigin[f.idx()]] += part;
  }
  for (const double a : area) EXPECT_NEAR(a, 1, 1e-9);
}

/// What an embedding promises beyond `verify`.
void expectEmbedding(const Parametrization& map, const TMesh& tmesh, const EmbeddedTMesh& embedded) {
  for (const auto& arc : embedded.arcs) EXPECT_GT(arc.length, 0);
  for (std::size_t n = 0; n < tmesh.nodes.size(); ++n)
    if (tmesh.nodes[n].critical) {
      const VertexHandle v = embedded[embedded.nodeOf[n]].vertex;
      EXPECT_EQ(v, std::get<VertexHandle>(tmesh.nodes[n].place->element));
      EXPECT_TRUE(embedded[embedded.nodeOf[n]].critical);
    }
  std::set<EdgeHandle> onCurves;
  for (std::size_t a = 0; a < embedded.arcs.size(); ++a)
    if (embedded.arcs[a].onCurve)
      for (const auto h : embedded.halfedges({ArcId{int(a)}, true}))
        onCurves.insert(embedded.surface.mesh.edge_handle(h));
  for (const auto e : refinedEdges(map.mesh, embedded.surface, map.aligned))
    EXPECT_TRUE(onCurves.contains(e));
  expectSubdivision(map.mesh, embedded.surface);
}

}  // namespace

TEST(Embed, randomSurfaces) {
  const Progress progress;
  int operations = 0, zeroArcs = 0;
  for (unsigned seed = 0; seed < sample::rounds(200) && !testing::Test::HasFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const GridMap map = randomMap(seed);
    const TMesh tmesh = partition(map, progress);
    const Quantization quantization = quantize(tmesh, {}, progress);
    try {
      const EmbeddedTMesh embedded = embed(map, tmesh, quantization, progress, [&](const EmbeddedTMesh& e) {
        verify(e);
        ++operations;
      });
      expectEmbedding(map, tmesh, embedded);
    } catch (const std::exception& error) {
      ADD_FAILURE() << error.what();
    }
    zeroArcs += quantization.zeroArcs;
  }
  EXPECT_GT(zeroArcs, int(sample::rounds(400)));
  EXPECT_GT(operations, zeroArcs);
}

TEST(Embed, isTheSameFromRunToRun) {
  const Progress progress;
  const GridMap map = randomMap(7);
  const TMesh tmesh = partition(map, progress);
  const Quantization quantization = quantize(tmesh, {}, progress);
  const EmbeddedTMesh a = embed(map, tmesh, quantization, progress),
                      b = embed(map, tmesh, quantization, progress);
  ASSERT_EQ(a.arcs.size(), b.arcs.size());
  for (std::size_t k = 0; k < a.arcs.size(); ++k) EXPECT_EQ(a.arcs[k].path, b.arcs[k].path);
  EXPECT_EQ(a.surface.faceOrigin, b.surface.faceOrigin);
}

TEST(Embed, anArcOfLengthZeroOnTheGridNeedsNoNewVertices) {
  // Two features on a lattice whose lines are mesh edges: all arcs run along these already.
  GridMap map = planarMap(sheet(6, 6, [](int i, int j) { return Eigen::Vector2d(i, j); }));
  for (const int v : {16, 32}) map.featurePoints.push_back(VertexHandle(v));
  const Progress progress;
  const TMesh tmesh = partition(map, progress);
  const EmbeddedTMesh embedded = embed(map, tmesh, quantize(tmesh, {}, progress), progress);
  EXPECT_EQ(embedded.counters.crossings, 0);
  EXPECT_EQ(embedded.counters.inserted, 0);
}

TEST(Embed, stopsWhenCancelled) {
  const Progress running;
  const GridMap map = randomMap(7);
  const TMesh tmesh = partition(map, running);
  const Quantization quantization = quantize(tmesh, {}, running);
  Progress progress;
  progress.cancel();
  EXPECT_THROW(embed(map, tmesh, quantization, progress), Error);
}
