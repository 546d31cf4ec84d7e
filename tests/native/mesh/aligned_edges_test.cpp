#include <algorithm>
#include <set>

#include "support/error_of.h"
#include "support/mesh_samples.h"
#include "trimquad/mesh/mesh_model.h"
#include "trimquad/mesh/split_triangles.h"

namespace trimquad {
namespace {

using Sharp = FeatureOptions::Sharp;

Region regionOf(const TriangleSoup& soup, const FeatureOptions& features) {
  Model model = meshModel(soup, {.features = features}, Progress{});
  EXPECT_EQ(model.regions.size(), 1u);
  return std::move(model.regions[0]);
}

double alignedLength(const Region& region) {
  double length = 0;
  for (const auto e : region.aligned) length += region.mesh.calc_edge_length(e);
  return length;
}

/// What a locally injective map with these constraints needs, and that the bookkeeping kept up.
void expectPrepared(const Region& region) {
  const auto& mesh = region.mesh;
  std::set<EdgeHandle> aligned(region.aligned.begin(), region.aligned.end());
  std::set<VertexHandle> held(region.featurePoints.begin(), region.featurePoints.end());
  for (const auto e : aligned)
    for (const int side : {0, 1}) held.insert(mesh.to_vertex_handle(mesh.halfedge_handle(e, side)));
  EXPECT_TRUE(std::is_sorted(region.aligned.begin(), region.aligned.end()));
  EXPECT_TRUE(std::is_sorted(region.featurePoints.begin(), region.featurePoints.end()));
  for (const auto f : mesh.faces()) {
    int edges = 0, corners = 0;
    for (const auto h : mesh.fh_range(f)) {
      edges += int(aligned.count(mesh.edge_handle(h)));
      corners += int(held.count(mesh.from_vertex_handle(h)));
    }
    EXPECT_LE(edges, 1);
    EXPECT_LE(corners, 2);
  }
  for (const auto e : mesh.edges()) {
    const auto h = mesh.halfedge_handle(e, 0);
    if (!mesh.is_boundary(e) && !aligned.count(e)) {
      EXPECT_FALSE(held.count(mesh.to_vertex_handle(h)) && held.count(mesh.from_vertex_handle(h)));
    }
    EXPECT_EQ(region.edgeCurve[e.idx()].has_value(), mesh.is_boundary(e));
  }
  EXPECT_EQ(region.corner.size(), mesh.n_vertices());
  EXPECT_EQ(region.curveParameter.size(), mesh.n_vertices());
  EXPECT_EQ(region.inputTriangle.size(), mesh.n_faces());
}

/// Every triangle lies in the triangle of the soup that it says it comes from.
void expectInsideInput(const Region& region, const TriangleSoup& soup) {
  const auto& mesh = region.mesh;
  for (const auto f : mesh.faces()) {
    const auto& t = soup.triangles[region.inputTriangle[f.idx()]];
    const Eigen::Vector3d &a = soup.points[t[0]], &b = soup.points[t[1]], &c = soup.points[t[2]];
    const Eigen::Vector3d n = (b - a).cross(c - a);
    const Eigen::Vector3d p = mesh.calc_face_centroid(f);
    EXPECT_GE((b - a).cross(p - a).dot(n), -1e-9);
    EXPECT_GE((c - b).cross(p - b).dot(n), -1e-9);
    EXPECT_GE((a - c).cross(p - c).dot(n), -1e-9);
    EXPECT_NEAR(n.normalized().dot(p - a), 0, 1e-9);
  }
}

TEST(AlignedEdges, aCubeKeepsItsEdgesAndEveryTriangleGetsAFreeCorner) {
  const auto soup = cube();
  const Region region = regionOf(soup, {.sharp = Sharp::Align});
  EXPECT_DOUBLE_EQ(alignedLength(region), 12);
  EXPECT_NEAR(surfaceArea(region.mesh), 6, 1e-12);
  EXPECT_EQ(eulerCharacteristic(region.mesh), 2);
  expectPrepared(region);
  expectInsideInput(region, soup);
}

TEST(AlignedEdges, anAlignedBoundaryLeavesNoChord) {
  const auto soup = flatSheet(5, 3);
  const Region region = regionOf(soup, {.alignBoundary = true});
  EXPECT_DOUBLE_EQ(alignedLength(region), 16);
  expectPrepared(region);
  expectInsideInput(region, soup);
}

TEST(AlignedEdges, aSingleTriangleAlignedAllAroundIsSplitInside) {
  TriangleSoup soup;
  soup.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  soup.triangles = {{0, 1, 2}};
  const Region region = regionOf(soup, {.alignBoundary = true});
  EXPECT_EQ(region.mesh.n_faces(), 3u);
  expectPrepared(region);
}

TEST(AlignedEdges, aFreeRegionStaysAsItIs) {
  const auto soup = flatSheet(5, 3);
  const Region region = regionOf(soup, {});
  EXPECT_EQ(region.mesh.n_faces(), soup.triangles.size());
  EXPECT_TRUE(region.aligned.empty());
}

TEST(AlignedEdges, piecesOfALoopCanBeChosenOneByOne) {
  const auto soup = flatSheet(5, 3);
  EXPECT_DOUBLE_EQ(alignedLength(regionOf(soup, {.align = {"loop:0"}})), 16);
  double sum = 0;
  for (const char* piece : {"loop:0/0", "loop:0/1", "loop:0/2", "loop:0/3"}) {
    const double length = alignedLength(regionOf(soup, {.align = {piece}}));
    EXPECT_TRUE(std::abs(length - 5) < 1e-12 || std::abs(length - 3) < 1e-12);
    EXPECT_DOUBLE_EQ(alignedLength(regionOf(soup, {.alignBoundary = true, .free = {piece}})), 16 - length);
    sum += length;
  }
  EXPECT_DOUBLE_EQ(sum, 16);
}

TEST(AlignedEdges, anglesChooseInnerEdges) {
  auto bar = cube();
  for (auto& p : bar.points) p.x() += 0.5 * p.z();  // two pairs of faces at 63 and 117 degrees
  EXPECT_EQ(regionOf(bar, {.align = {"angle:60-70"}}).aligned.size(), 2u);
  EXPECT_EQ(regionOf(bar, {.sharp = Sharp::Align, .free = {"angle:60-70"}}).aligned.size(), 10u);
}

TEST(AlignedEdges, whatIsNotThereIsRefusedWithWhatThereIs) {
  for (const char* name : {"loop:7", "Edge3", "loop", "loop:0/9", "feature:0"}) {
    const auto error = errorOf([&] { regionOf(flatSheet(3, 3), {.align = {name}}); });
    ASSERT_TRUE(error) << name;
    EXPECT_EQ(error->kind(), Error::Kind::Input);
    EXPECT_NE(error->message().find(name), std::string::npos);
    EXPECT_NE(error->message().find("loop:0/0"), std::string::npos);
  }
  for (const char* name : {"angle:", "angle:30", "angle:40-30", "angle:-5-30", "angle:0-190", "angle:a-b"})
    EXPECT_TRUE(errorOf([&] { regionOf(flatSheet(3, 3), {.align = {name}}); })) << name;
}

TEST(AlignedEdges, bordersBetweenRegionsAreAlignedOnBothSides) {
  const Model model = meshModel(
      cube(), {.features = {.sharp = Sharp::Trim, .alignBoundary = true, .free = {"feature:0"}}}, Progress{});
  ASSERT_EQ(model.regions.size(), 6u);
  double length = 0;
  for (const auto& region : model.regions) {
    expectPrepared(region);
    length += alignedLength(region);
  }
  EXPECT_DOUBLE_EQ(length, 22);
}

TEST(FeaturePoints, aPointInsideATriangleAnEdgeAndACornerBecomesAVertex) {
  const auto soup = flatSheet(4, 4);
  const std::vector<Eigen::Vector3d> points{{1.6, 1.2, 0}, {2.5, 2, 0}, {3, 1, 0}, {0, 1.5, 0}, {4, 4, 0}};
  const Region region = regionOf(soup, {.points = points, .quadLength = 1});
  ASSERT_EQ(region.featurePoints.size(), points.size());
  for (const auto& p : points) {
    int found = 0;
    for (const auto v : region.featurePoints) found += (region.mesh.point(v) - p).norm() < 1e-12;
    EXPECT_EQ(found, 1);
  }
  EXPECT_NEAR(surfaceArea(region.mesh), 16, 1e-12);
  expectPrepared(region);
  expectInsideInput(region, soup);
}

TEST(FeaturePoints, aPointOffTheSurfaceIsRefused) {
  const auto error = errorOf([] { regionOf(flatSheet(4, 4), {.points = {{1, 1, 0.7}}, .quadLength = 1}); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->kind(), Error::Kind::Input);
  EXPECT_TRUE(error->position());
}

TEST(FeaturePoints, randomPointsAndFoldsKeepTheContract) {
  const unsigned seed = std::random_device{}();
  std::mt19937 random(seed);
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::uniform_real_distribution<double> place(0, 6);
  for (int round = 0; round < 30; ++round) {
    const auto soup =
        sheet(6, 6, [&](double i, double j) { return Eigen::Vector3d(i, j, 0.4 * double(random() % 3)); });
    FeatureOptions features{.sharp = Sharp::Align, .angle = 25, .alignBoundary = random() % 2 == 0};
    features.quadLength = 2;
    for (int i = 0; i < 4; ++i) features.points.emplace_back(place(random), place(random), 0.4);
    const Region region = regionOf(soup, features);
    expectPrepared(region);
    expectInsideInput(region, soup);
    EXPECT_NEAR(surfaceArea(region.mesh), surfaceArea(buildSurfaceMesh(soup)), 1e-9);
  }
}

}  // namespace
}  // namespace trimquad
