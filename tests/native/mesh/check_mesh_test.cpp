#include "trimquad/mesh/check_mesh.h"

#include <algorithm>

#include "support/error_of.h"
#include "support/mesh_samples.h"

namespace trimquad {
namespace {

std::string complaint(TriangleSoup soup) {
  const auto error = errorOf([&] { repair(soup); });
  EXPECT_TRUE(error);
  if (!error) return {};
  EXPECT_EQ(error->kind(), Error::Kind::Input);
  return error->what();
}

TEST(CheckMesh, aGoodMeshStaysBitwiseTheSame) {
  for (const TriangleSoup& soup : {flatSheet(4, 3), cube(), sphere(2, 2), band(12, 0), band(12, 2)}) {
    TriangleSoup repaired = soup;
    const RepairReport report = repair(repaired);
    EXPECT_FALSE(report.changed()) << report.summary();
    EXPECT_EQ(repaired.points, soup.points);
    EXPECT_EQ(repaired.triangles, soup.triangles);
  }
}

TEST(CheckMesh, cracksAreWeldedAndNothingElse) {
  TriangleSoup soup = exploded(sphere(1, 2));
  const RepairReport report = repair(soup);
  EXPECT_EQ(eulerCharacteristic(buildSurfaceMesh(soup)), 2);
  EXPECT_EQ(report.weldedVertices, int(3 * soup.triangles.size() - soup.points.size()));
}

TEST(CheckMesh, sheetsThatTouchInAPointAreNotWelded) {
  TriangleSoup soup;
  soup.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {-1, 0, 0}, {0, -1, 0}};
  soup.triangles = {{0, 1, 2}, {3, 4, 5}};
  EXPECT_EQ(repair(soup).weldedVertices, 0);
  EXPECT_EQ(soup.points.size(), 6u);
}

TEST(CheckMesh, threeSheetsAtACrackAreLeftApart) {
  TriangleSoup soup;
  for (const auto& tip : {Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, -1, 1), Eigen::Vector3d(0, 0, -1)}) {
    const int n = int(soup.points.size());
    soup.points.insert(soup.points.end(), {{0, 0, 0}, {1, 0, 0}, tip});
    soup.triangles.push_back({n, n + 1, n + 2});
  }
  EXPECT_EQ(repair(soup).weldedVertices, 0);
}

TEST(CheckMesh, aBowTieVertexIsSplit) {
  TriangleSoup soup;
  soup.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  soup.triangles = {{0, 1, 2}, {0, 3, 4}};
  EXPECT_TRUE(errorOf([&] { buildSurfaceMesh(soup); }));
  EXPECT_EQ(repair(soup).splitVertices, 1);
  EXPECT_EQ(buildSurfaceMesh(soup).n_vertices(), 6u);
}

TEST(CheckMesh, uselessElementsAreDropped) {
  TriangleSoup soup = flatSheet(2, 2);
  const TriangleSoup clean = soup;
  soup.points.insert(soup.points.begin(), Eigen::Vector3d(7, 7, 7));
  for (auto& t : soup.triangles)
    for (int& v : t) ++v;
  soup.triangles.push_back({2, 2, 3});
  auto turned = soup.triangles[3];
  std::swap(turned[0], turned[1]);
  soup.triangles.insert(soup.triangles.begin() + 5, turned);
  const RepairReport report = repair(soup);
  EXPECT_EQ(report.unusedVertices, 1);
  EXPECT_EQ(report.repeatedCorners, 1);
  EXPECT_EQ(report.duplicateTriangles, 1);
  EXPECT_EQ(soup.points, clean.points);
  EXPECT_EQ(soup.triangles, clean.triangles);
  EXPECT_EQ(report.triangle, (std::vector<int>{0, 1, 2, 3, 4, 6, 7, 8}));
  EXPECT_EQ(
      report.summary(),
      "1 unused vertex dropped, 1 triangle with a repeated corner dropped, 1 duplicate triangle dropped");
}

TEST(CheckMesh, randomlyTurnedTrianglesOfAClosedSurfaceFaceOutward) {
  const unsigned seed = 11;
  std::mt19937 random(seed);
  TriangleSoup soup = sphere(1, 3);
  const double volume = enclosedVolume(soup);
  for (auto& t : soup.triangles)
    if (random() % 10 < 7) std::swap(t[0], t[1]);
  repair(soup);
  buildSurfaceMesh(soup);
  EXPECT_NEAR(enclosedVolume(soup), volume, 1e-12);
}

TEST(CheckMesh, anOpenSurfaceKeepsTheSideOfTheMajority) {
  TriangleSoup soup = flatSheet(5, 5);
  for (std::size_t t = 0; t < soup.triangles.size(); t += 3)
    std::swap(soup.triangles[t][0], soup.triangles[t][1]);
  repair(soup);
  const SurfaceMesh mesh = buildSurfaceMesh(soup);
  for (const auto f : mesh.faces()) EXPECT_GT(mesh.calc_face_normal(f).z(), 0);
}

TEST(CheckMesh, everyComponentIsOrientedForItself) {
  TriangleSoup soup = cube();
  const TriangleSoup other = cube();
  for (const auto& p : other.points) soup.points.push_back(p + Eigen::Vector3d(5, 0, 0));
  for (const auto& [a, b, c] : other.triangles) soup.triangles.push_back({a + 8, c + 8, b + 8});
  EXPECT_EQ(repair(soup).turnedTriangles, 12);
  EXPECT_NEAR(enclosedVolume(soup), 2, 1e-12);
}

TEST(CheckMesh, aOneSidedSurfaceIsRefused) {
  EXPECT_NE(complaint(band(12, 1)).find("one side"), std::string::npos);
  EXPECT_NE(complaint(band(15, 3)).find("one side"), std::string::npos);
}

TEST(CheckMesh, branchingEdgesAreCountedAndPlaced) {
  TriangleSoup soup = cube();
  soup.points.emplace_back(3, 3, 3);
  soup.triangles.push_back({0, 1, 8});
  EXPECT_NE(complaint(soup).find("an edge has more than two triangles"), std::string::npos);
  EXPECT_NE(complaint(soup).find("vertices 0 and 1) at (0.5, 0, 0)"), std::string::npos);
  soup.triangles.push_back({6, 7, 8});
  EXPECT_NE(complaint(soup).find("2 edges"), std::string::npos);
}

TEST(CheckMesh, aCapIsFlippedAway) {
  // Vertex 4 lies on the edge 0-1; the triangle between them has no area.
  TriangleSoup soup;
  soup.points = {{0, 0, 0}, {2, 0, 0}, {1, 2, 0}, {1, -2, 0}, {1, 0, 0}};
  soup.triangles = {{0, 1, 4}, {0, 4, 2}, {4, 1, 2}, {1, 0, 3}};
  EXPECT_EQ(repair(soup).flatTriangles, 1);
  const SurfaceMesh mesh = buildSurfaceMesh(soup);
  EXPECT_EQ(mesh.n_faces(), 4u);
  EXPECT_NEAR(surfaceArea(mesh), 4, 1e-14);
  for (const auto f : mesh.faces()) EXPECT_NEAR(mesh.calc_face_area(f), 1, 1e-14);
}

TEST(CheckMesh, aCapOnTheBoundaryIsDropped) {
  TriangleSoup soup;
  soup.points = {{0, 0, 0}, {2, 0, 0}, {1, 2, 0}, {1, 0, 0}};
  soup.triangles = {{0, 1, 3}, {0, 3, 2}, {3, 1, 2}};
  EXPECT_EQ(repair(soup).flatTriangles, 1);
  EXPECT_EQ(buildSurfaceMesh(soup).n_faces(), 2u);
}

TEST(CheckMesh, aNeedleIsCollapsed) {
  TriangleSoup soup = flatSheet(4, 4);
  // Vertex 12 is (2, 2); its neighbour 17 at (3, 2) comes next to it.
  soup.points[17] = soup.points[12] + Eigen::Vector3d(1e-12, 0, 0);
  const RepairReport report = repair(soup);
  EXPECT_EQ(report.flatTriangles, 2);
  const SurfaceMesh mesh = buildSurfaceMesh(soup);
  EXPECT_EQ(mesh.n_faces(), 30u);
  EXPECT_EQ(report.triangle.size(), 30u);
  EXPECT_NEAR(surfaceArea(mesh), 16, 1e-9);
  EXPECT_EQ(eulerCharacteristic(mesh), 1);
}

TEST(CheckMesh, trianglesWithoutAnyAreaAreRefused) {
  TriangleSoup soup;
  soup.points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  soup.triangles = {{0, 1, 2}};
  EXPECT_NE(complaint(soup).find("no area"), std::string::npos);
  soup.points = {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}};
  EXPECT_NE(complaint(soup).find("area"), std::string::npos);
}

TEST(CheckMesh, nonsenseIsRefused) {
  TriangleSoup soup = cube();
  soup.triangles[2][1] = 8;
  EXPECT_NE(complaint(soup).find("triangle 2"), std::string::npos);
  soup = cube();
  soup.points[5].y() = std::nan("");
  EXPECT_NE(complaint(soup).find("vertex 5"), std::string::npos);
  EXPECT_NE(complaint({}).find("no triangles"), std::string::npos);
}

TEST(CheckMesh, randomTrianglesEndInAManifoldOrInAnError) {
  const unsigned seed = std::random_device{}();
  std::mt19937 random(seed);
  SCOPED_TRACE("seed " + std::to_string(seed));
  for (int round = 0; round < 3000; ++round) {
    TriangleSoup soup;
    const int n = 3 + int(random() % 8);
    // A coarse lattice: many coincident and collinear points.
    for (int i = 0; i < n; ++i)
      soup.points.emplace_back(int(random() % 3), int(random() % 3), int(random() % 2));
    const int count = 1 + int(random() % 7);
    for (int t = 0; t < count; ++t)
      soup.triangles.push_back({int(random() % n), int(random() % n), int(random() % n)});
    if (const auto error = errorOf([&] { repair(soup); })) {
      EXPECT_EQ(error->kind(), Error::Kind::Input);
      continue;
    }
    const SurfaceMesh mesh = buildSurfaceMesh(soup);
    for (const auto f : mesh.faces()) EXPECT_GT(mesh.calc_face_area(f), 0);
    for (const auto v : mesh.vertices()) EXPECT_FALSE(mesh.is_isolated(v));
    TriangleSoup again = soup;
    const RepairReport report = repair(again);
    EXPECT_FALSE(report.changed()) << report.summary() << " in round " << round;
  }
}

TEST(CheckMesh, sidesThatWeldingBringsTogetherAreOneEdge) {
  // Three sheets lie on the crack from (2, 1, 0) to (1, 1, 1); welding elsewhere closes a tetrahedron along
  // it.
  TriangleSoup soup;
  soup.points = {{2, 1, 0}, {1, 1, 1}, {0, 0, 1}, {1, 1, 1}, {2, 1, 0}, {2, 2, 1}, {2, 1, 0}, {0, 1, 0}};
  soup.triangles = {{4, 5, 3}, {7, 1, 2}, {2, 4, 7}, {1, 6, 2}, {0, 7, 3}};
  repair(soup);
  TriangleSoup again = soup;
  EXPECT_FALSE(repair(again).changed());
}

}  // namespace
}  // namespace trimquad
