#include "trimquad/mesh/collapse_edge.h"

#include <random>

#include "support/mesh_samples.h"

using namespace trimquad;

namespace {

SurfaceMesh pierced() {
  TriangleSoup soup = sheet(9, 8, [](double i, double j) { return Eigen::Vector3d(i, j, 0.1 * i * j); });
  std::erase_if(soup.triangles, [&](const auto& t) { return t[0] == 24 || t[0] == 51; });
  return buildSurfaceMesh(soup);
}

void expectSameMesh(const SurfaceMesh& a, const SurfaceMesh& b) {
  ASSERT_EQ(a.n_vertices(), b.n_vertices());
  ASSERT_EQ(a.n_edges(), b.n_edges());
  ASSERT_EQ(a.n_faces(), b.n_faces());
  for (int v = 0; v < int(a.n_vertices()); ++v) {
    EXPECT_EQ(a.halfedge_handle(VertexHandle(v)), b.halfedge_handle(VertexHandle(v)));
    EXPECT_EQ(a.point(VertexHandle(v)), b.point(VertexHandle(v)));
    EXPECT_EQ(a.status(VertexHandle(v)).deleted(), b.status(VertexHandle(v)).deleted());
  }
  for (int i = 0; i < int(a.n_halfedges()); ++i) {
    const HalfedgeHandle h(i);
    EXPECT_EQ(a.status(h).deleted(), b.status(h).deleted());
    EXPECT_EQ(a.status(a.edge_handle(h)).deleted(), b.status(b.edge_handle(h)).deleted());
    EXPECT_EQ(a.to_vertex_handle(h), b.to_vertex_handle(h));
    EXPECT_EQ(a.next_halfedge_handle(h), b.next_halfedge_handle(h));
    EXPECT_EQ(a.prev_halfedge_handle(h), b.prev_halfedge_handle(h));
    EXPECT_EQ(a.face_handle(h), b.face_handle(h));
  }
  for (int f = 0; f < int(a.n_faces()); ++f) {
    EXPECT_EQ(a.halfedge_handle(FaceHandle(f)), b.halfedge_handle(FaceHandle(f)));
    EXPECT_EQ(a.status(FaceHandle(f)).deleted(), b.status(FaceHandle(f)).deleted());
  }
}

}  // namespace

TEST(CollapseEdge, givesWhatOpenMeshGives) {
  for (unsigned seed = 0; seed < 60 && !testing::Test::HasFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    SurfaceMesh mesh = pierced(), openMesh = mesh;
    int collapses = 0;
    for (unsigned k = 0; k < 10 * (seed + 1); ++k) {
      const HalfedgeHandle h(int(random() % mesh.n_halfedges()));
      if (mesh.status(mesh.edge_handle(h)).deleted() || !openMesh.is_collapse_ok(h)) continue;
      collapseEdge(mesh, h);
      openMesh.collapse(h);
      ++collapses;
    }
    EXPECT_GT(collapses, 0);
    expectSameMesh(mesh, openMesh);
    takeOutDeleted(mesh);
    openMesh.garbage_collection();
    expectSameMesh(mesh, openMesh);
  }
}

TEST(CollapseEdge, whatIsMovedIsNamed) {
  SurfaceMesh mesh = pierced();
  std::vector<Eigen::Vector3d> place;
  for (const auto v : mesh.vertices()) place.push_back(mesh.point(v));
  for (int i = 0; i < int(mesh.n_halfedges()); i += 17)
    if (!mesh.status(HalfedgeHandle(i)).deleted() && mesh.is_collapse_ok(HalfedgeHandle(i)))
      collapseEdge(mesh, HalfedgeHandle(i));
  const auto renumbered = takeOutDeleted(mesh);
  ASSERT_FALSE(renumbered.vertices.empty());
  for (const auto& [from, to] : renumbered.vertices) place[std::size_t(to)] = place[std::size_t(from)];
  for (const auto v : mesh.vertices()) EXPECT_EQ(mesh.point(v), place[std::size_t(v.idx())]);
}

TEST(CollapseEdge, halfedgesAreFoundByTheirEnds) {
  const SurfaceMesh mesh = pierced();
  for (const auto v : mesh.vertices())
    for (const auto w : mesh.vertices()) EXPECT_EQ(halfedgeBetween(mesh, v, w), mesh.find_halfedge(v, w));
}
