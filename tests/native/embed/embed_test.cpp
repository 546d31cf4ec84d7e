#include "trimquad/embed/embed.h"
#include "support/rounds.h"

#include "support/random_surfaces.h"
#include "support/tmesh_checks.h"
#include "trimquad/base/error.h"
#include "trimquad/mesh/collapse_edge.h"

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

/// The triangles within each patch's loop, reached from one to the next, are an open disk, and all there are.
void expectDisks(const EmbeddedTMesh& embedded) {
  const auto& mesh = embedded.surface.mesh;
  std::set<EdgeHandle> arcEdges;
  std::set<VertexHandle> arcVertices;
  for (std::size_t a = 0; a < embedded.arcs.size(); ++a) {
    if (embedded.arcs[a].removed) continue;
    for (const auto h : embedded.halfedges({ArcId{int(a)}, true})) arcEdges.insert(mesh.edge_handle(h));
    arcVertices.insert(embedded.arcs[a].path.begin(), embedded.arcs[a].path.end());
  }
  std::set<FaceHandle> covered;
  for (std::size_t p = 0; p < embedded.patches.size(); ++p) {
    if (embedded.patches[p].removed) continue;
    std::vector<FaceHandle> inside;
    std::set<EdgeHandle> edges;
    std::set<VertexHandle> vertices;
    const auto reach = [&](FaceHandle f) {
      if (covered.insert(f).second) inside.push_back(f);
    };
    reach(mesh.face_handle(embedded.halfedges(embedded.loop(PatchId{int(p)}).front()).front()));
    for (std::size_t k = 0; k < inside.size(); ++k)
      for (const auto h : mesh.fh_range(inside[k])) {
        if (!arcVertices.contains(mesh.to_vertex_handle(h))) vertices.insert(mesh.to_vertex_handle(h));
        if (arcEdges.contains(mesh.edge_handle(h))) continue;
        edges.insert(mesh.edge_handle(h));
        reach(mesh.opposite_face_handle(h));
      }
    EXPECT_EQ(int(vertices.size()) - int(edges.size()) + int(inside.size()), 1);
  }
  for (const auto f : mesh.all_faces()) EXPECT_NE(covered.contains(f), mesh.status(f).deleted());
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
  expectDisks(embedded);
}

/// A tube of three columns between two borders of one arc each.
EmbeddedTMesh tubeBetweenLoops() {
  EmbeddedTMesh tube;
  tube.surface =
      unrefined(buildSurfaceMesh({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}},
                                  {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}, {2, 0, 3}, {2, 3, 5}}}));
  for (const int first : {0, 3}) {
    const VertexHandle a(first), b(first + 1), c(first + 2);
    const NodeId node{int(tube.nodes.size())};
    tube.nodes.push_back({a, false, true});
    tube.arcs.push_back({node, node, 1, true, true, {a, b, c, a}});
  }
  return tube;
}

}  // namespace

TEST(Embed, randomSurfaces) {
  const Progress progress;
  int operations = 0, zeroArcs = 0;
  for (unsigned seed = 0; seed < sample::rounds(100) && !testing::Test::HasFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const GridMap map = randomMap(seed);
    const TMesh tmesh = partition(map, progress);
    const Quantization quantization = quantize(tmesh, {}, progress);
    try {
      const EmbeddedTMesh embedded = embed(map, tmesh, quantization, progress, [&](const EmbeddedTMesh& e) {
        verify(e);
        if (++operations % 10 == 0) expectDisks(e);
      });
      expectEmbedding(map, tmesh, embedded);
    } catch (const std::exception& error) {
      ADD_FAILURE() << error.what();
    }
    zeroArcs += quantization.zeroArcs;
  }
  EXPECT_GT(zeroArcs, int(sample::rounds(200)));
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

namespace {

/// A slanted sheet of 40 x 40 cells of 0.2 quads with some of its vertices as feature points.
GridMap slantedSheet(const std::vector<std::array<int, 2>>& features) {
  constexpr int kCells = 40;
  GridMap map = planarMap(sheet(
      kCells, kCells, [](int i, int j) { return Eigen::Vector2d(0.2 * i + 0.06 * j, 0.2 * j - 0.06 * i); }));
  for (const auto& [i, j] : features) map.featurePoints.push_back(VertexHandle(j * (kCells + 1) + i));
  return map;
}

/// Arcs run along edges of the refined mesh and meet in nodes only. How many vertices they needed.
int inserted(const GridMap& map, int& crossings) {
  RefinedMesh surface;
  const ArcPaths paths = insertArcs(map, partition(map, Progress()), surface);
  std::set<VertexHandle> inside;
  for (const auto& path : paths.arc)
    for (std::size_t k = 1; k < path.size(); ++k) {
      EXPECT_TRUE(halfedgeBetween(surface.mesh, path[k - 1], path[k]).is_valid());
      const bool isNew = k + 1 == path.size() || inside.insert(path[k]).second;
      EXPECT_TRUE(isNew);
    }
  crossings = paths.crossings;
  return int(surface.mesh.n_vertices() - map.mesh.n_vertices());
}

}  // namespace

TEST(Embed, arcsWithNothingElseNearRunAlongEdges) {
  // Two feature points far from each other, their arcs slanted against the mesh.
  int crossings = 0;
  EXPECT_LT(inserted(slantedSheet({{12, 10}, {30, 29}}), crossings), 20);
  EXPECT_GT(crossings, 200);
}

TEST(Embed, arcsBesideEachOtherRunAlongEdgesOnEitherSide) {
  // Two feature points side by side: pairs of arcs pass through the same triangles.
  int crossings = 0;
  EXPECT_LT(inserted(slantedSheet({{20, 20}, {21, 21}}), crossings), 40);
  EXPECT_GT(crossings, 200);
}

TEST(Embed, anArcThatSlidesKeepsItsPathAsFarAsItCan) {
  // Two feature points half a quad apart in both directions, on finer and finer meshes: of their arcs, which
  // cross the whole sheet side by side, each pair becomes one.
  const Progress progress;
  std::vector<int> splits;
  for (const int n : {24, 48, 96}) {
    GridMap map = planarMap(sheet(n, n, [&](int i, int j) {
      return Eigen::Vector2d(6.0 * i / n + 0.1 * j / n, 6.0 * j / n - 0.1 * i / n);
    }));
    const int near = n / 2 * (n + 1) + n / 2, step = n / 24;
    for (const int v : {near, near + step * (n + 2)}) map.featurePoints.push_back(VertexHandle(v));
    const TMesh tmesh = partition(map, progress);
    const EmbeddedTMesh embedded = embed(map, tmesh, quantize(tmesh, {}, progress), progress);
    EXPECT_GT(embedded.counters.zeroArcCollapses, 0);
    splits.push_back(embedded.counters.splits);
  }
  EXPECT_LE(splits.back(), 2 * splits.front());
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

TEST(Embed, aPatchThatIsNoDiskIsFound) {
  // Two loops that are complete, around the same tube.
  EmbeddedTMesh tube = tubeBetweenLoops();
  for (const bool isTop : {false, true}) {
    const HalfArc loop{ArcId{isTop}, !isTop};
    tube.patches.push_back({{{{loop}, {}, {loop}, {}}}});
    tube.patches.back().sides[2].clear();
    tube.arcs[isTop].length = 0;
  }
  EXPECT_ANY_THROW(verify(tube));
  // Cut open between its borders it is one.
  tube.arcs.push_back({NodeId{0}, NodeId{1}, 1, false, false, {VertexHandle(0), VertexHandle(3)}});
  const HalfArc bottom{ArcId{0}, true}, top{ArcId{1}, false}, cut{ArcId{2}, true};
  tube.patches = {{{{{bottom}, {cut}, {top}, {cut.opposite()}}}}};
  EXPECT_NO_THROW(verify(tube));
  // What a removed patch leaves is none.
  tube.patches.front().removed = true;
  EXPECT_ANY_THROW(verify(tube));
}
