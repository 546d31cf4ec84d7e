#include "trimquad/mesh/replace_triangles.h"

#include <algorithm>
#include <random>
#include <set>

#include "support/mesh_samples.h"

using namespace trimquad;

namespace {

/// A sheet with a hole.
SurfaceMesh piercedSheet() {
  TriangleSoup soup = trimquad::sheet(6, 5, [](double i, double j) { return Eigen::Vector3d(i, j, 0); });
  std::erase_if(soup.triangles, [&](const auto& t) { return t[0] == 14; });
  return buildSurfaceMesh(soup);
}

/// Parts of the triangles of which edges are cut in the middle: fans around a cut corner or a middle.
std::vector<TrianglePart> partsOf(const SurfaceMesh& mesh, const std::map<EdgeHandle, VertexHandle>& middle) {
  std::vector<TrianglePart> parts;
  for (const auto f : mesh.faces()) {
    std::vector<VertexHandle> outline;
    std::size_t start = 0;
    for (const auto h : mesh.fh_range(f)) {
      outline.push_back(mesh.from_vertex_handle(h));
      const auto cut = middle.find(mesh.edge_handle(h));
      if (cut == middle.end()) continue;
      start = outline.size();
      outline.push_back(cut->second);
    }
    const std::size_t n = outline.size();
    if (n == 3) continue;
    // From the only middle no diagonal runs along a side.
    if (n == 4) {
      parts.push_back({f, {outline[start], outline[(start + 1) % n], outline[(start + 2) % n]}});
      parts.push_back({f, {outline[start], outline[(start + 2) % n], outline[(start + 3) % n]}});
      continue;
    }
    // Cut off the corner between two middles, then fan what is left.
    while (outline.size() > 3) {
      std::size_t k = 0;
      const auto isMiddle = [&](std::size_t i) {
        return std::any_of(middle.begin(), middle.end(),
                           [&](const auto& m) { return m.second == outline[i % outline.size()]; });
      };
      while (k < outline.size() && !(isMiddle(k) && isMiddle(k + 2) && !isMiddle(k + 1))) ++k;
      if (k == outline.size()) {
        k = 0;
        while (!isMiddle(k)) ++k;
      }
      const std::size_t m = outline.size();
      parts.push_back({f, {outline[k], outline[(k + 1) % m], outline[(k + 2) % m]}});
      outline.erase(outline.begin() + long((k + 1) % m));
    }
    parts.push_back({f, {outline[0], outline[1], outline[2]}});
  }
  return parts;
}

std::set<std::array<int, 3>> trianglesOf(const SurfaceMesh& mesh) {
  std::set<std::array<int, 3>> triangles;
  for (const auto f : mesh.faces()) {
    std::array<int, 3> corner;
    int k = 0;
    for (const auto v : mesh.fv_range(f)) corner[k++] = v.idx();
    std::rotate(corner.begin(), std::min_element(corner.begin(), corner.end()), corner.end());
    triangles.insert(corner);
  }
  return triangles;
}

void expectSoundLinks(const SurfaceMesh& mesh) {
  for (const auto h : mesh.halfedges()) {
    EXPECT_EQ(mesh.prev_halfedge_handle(mesh.next_halfedge_handle(h)), h);
    EXPECT_EQ(mesh.from_vertex_handle(mesh.next_halfedge_handle(h)), mesh.to_vertex_handle(h));
    EXPECT_EQ(mesh.face_handle(mesh.next_halfedge_handle(h)), mesh.face_handle(h));
  }
  for (const auto v : mesh.vertices()) {
    EXPECT_EQ(mesh.from_vertex_handle(mesh.halfedge_handle(v)), v);
    bool border = false;
    for (const auto h : mesh.voh_range(v)) border = border || mesh.is_boundary(h);
    EXPECT_EQ(mesh.is_boundary(mesh.halfedge_handle(v)), border);
  }
}

}  // namespace

TEST(ReplaceTriangles, givesTheMeshOfThePartsAndLeavesAllElseAsItIs) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const SurfaceMesh before = piercedSheet();
    SurfaceMesh mesh = before;
    std::map<EdgeHandle, VertexHandle> middle;
    std::vector<EdgeHandle> cut;
    const unsigned every = 1 + seed % 5;
    for (const auto e : before.edges())
      if (random() % every == 0) {
        cut.push_back(e);
        middle[e] = mesh.add_vertex(before.calc_edge_midpoint(e));
      }
    const auto parts = partsOf(before, middle);
    replaceTriangles(mesh, parts, cut);

    auto expected = trianglesOf(before);
    for (const auto& part : parts) {
      std::array<int, 3> whole, corner;
      int k = 0;
      for (const auto v : before.fv_range(part.whole)) whole[k++] = v.idx();
      std::rotate(whole.begin(), std::min_element(whole.begin(), whole.end()), whole.end());
      expected.erase(whole);
      for (k = 0; k < 3; ++k) corner[k] = part.corner[k].idx();
      std::rotate(corner.begin(), std::min_element(corner.begin(), corner.end()), corner.end());
      expected.insert(corner);
    }
    EXPECT_EQ(trianglesOf(mesh), expected);
    EXPECT_EQ(eulerCharacteristic(mesh), eulerCharacteristic(before));
    EXPECT_EQ(boundaryLoops(mesh).size(), boundaryLoops(before).size());
    EXPECT_NEAR(surfaceArea(mesh), surfaceArea(before), 1e-12);
    expectSoundLinks(mesh);
  }
}
