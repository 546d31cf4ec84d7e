#include "trimquad/mesh/sharp_edges.h"

#include <algorithm>
#include <numbers>

#include "support/mesh_samples.h"
#include "trimquad/mesh/feature_graph.h"
#include "trimquad/mesh/mesh_model.h"

namespace trimquad {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

long sharpCount(const TriangleSoup& soup, const SharpEdgeOptions& options) {
  const auto sharp = sharpEdges(buildSurfaceMesh(soup), options);
  return std::count(sharp.begin(), sharp.end(), true);
}

/// A flat sheet that is folded along the line i = 6 by `degrees(j)`.
TriangleSoup fold(const std::function<double(double)>& degrees) {
  return sheet(12, 12, [=](double i, double j) {
    const double a = degrees(j) * kDegree, over = std::max(0.0, i - 6);
    return Eigen::Vector3d(i - over + over * std::cos(a), j, -over * std::sin(a));
  });
}

TEST(SharpEdges, aFoldIsPositiveOverARidgeAndNegativeInAValley) {
  for (const double degrees : {40.0, -40.0}) {
    const auto mesh = buildSurfaceMesh(fold([=](double) { return degrees; }));
    double most = 0;
    for (const auto e : mesh.edges())
      if (std::abs(foldAngle(mesh, e)) > std::abs(most)) most = foldAngle(mesh, e);
    EXPECT_NEAR(most, degrees * kDegree, 1e-12);
  }
}

TEST(SharpEdges, aCubeHasItsTwelveEdges) {
  EXPECT_EQ(sharpCount(cube(), {.angle = 30 * kDegree}), 12);
  EXPECT_EQ(sharpCount(cube(), {.angle = 30 * kDegree, .quadLength = 1, .shortest = 0.9}), 12);
  EXPECT_EQ(sharpCount(cube(), {.angle = 91 * kDegree}), 0);
}

TEST(SharpEdges, aCreaseThatFadesIsFollowedToHalfTheAngle) {
  const auto fading = fold([](double j) { return 40 - 3 * j; });
  const long sharpOnly = sharpCount(fading, {.angle = 30 * kDegree, .follow = false});
  const long followed = sharpCount(fading, {.angle = 30 * kDegree});
  EXPECT_GT(followed, sharpOnly + 3);
  EXPECT_LT(followed, 12);
}

TEST(SharpEdges, aBandOfAnglesLeavesOutWhatIsSharper) {
  const auto ridge = fold([](double) { return 50; });
  EXPECT_EQ(sharpCount(ridge, {.angle = 20 * kDegree, .most = 40 * kDegree}), 0);
  EXPECT_EQ(sharpCount(ridge, {.angle = 20 * kDegree, .most = 60 * kDegree}), 12);
}

TEST(SharpEdges, spikesAreNoiseAndAnEdgeAmongThemStays) {
  auto soup = fold([](double) { return 60; });
  const auto smooth = soup;
  for (const int j : {2, 6, 10}) soup.points[2 * 13 + j].z() += 0.8;
  const SharpEdgeOptions all{.angle = 30 * kDegree},
      filtered{.angle = 30 * kDegree, .quadLength = 1, .shortest = 4};
  EXPECT_GT(sharpCount(soup, all), 24);
  EXPECT_EQ(sharpCount(soup, filtered), 12);
  EXPECT_EQ(sharpCount(smooth, filtered), 12);
}

TEST(SharpEdges, theFacetsOfACoarseTubeAreNoEdgesUnlessTheyAreAsWideAsQuads) {
  constexpr int kFacets = 10;  // 36 degrees each
  const auto tube = sheet(kFacets - 2, 8, [](double i, double j) {
    const double a = 2 * std::numbers::pi * i / kFacets;
    return Eigen::Vector3d(std::cos(a), std::sin(a), 0.6 * j);
  });
  EXPECT_GT(sharpCount(tube, {.angle = 30 * kDegree}), 50);
  EXPECT_EQ(sharpCount(tube, {.angle = 30 * kDegree, .quadLength = 2}), 0);
  EXPECT_GT(sharpCount(tube, {.angle = 30 * kDegree, .quadLength = 0.25}), 50);
}

TEST(SharpEdges, foldsOfARollingSurfaceAreNoEdgesHoweverLargeTheTriangles) {
  // Every edge folds by up to 40 degrees, and the triangles are as wide as the quads.
  const auto rolling = sheet(24, 24, [](double i, double j) {
    return Eigen::Vector3d(i, j, 0.35 * std::sin(2.1 * i) * std::cos(1.7 * j));
  });
  EXPECT_GT(sharpCount(rolling, {.angle = 30 * kDegree}), 100);
  EXPECT_EQ(sharpCount(rolling, {.angle = 30 * kDegree, .quadLength = 1, .shortest = 2}), 0);
}

TEST(SharpEdges, chamfersCloseToEachOtherAreEdgesOfAFlatSurface) {
  // Grooves with 45 degree flanks, four to a row of flat strips: more than a fifth of the edges are sharp.
  const auto grooved = sheet(24, 24, [](double i, double j) {
    const int step = int(i) % 6;
    return Eigen::Vector3d(i, j, step == 2 || step == 3 ? 1 : 0);
  });
  EXPECT_EQ(sharpCount(grooved, {.angle = 30 * kDegree, .quadLength = 1, .shortest = 2}),
            sharpCount(grooved, {.angle = 30 * kDegree}));
}

TEST(SharpEdges, aShortEdgeBetweenLongOnesStays) {
  // A bar of 1 x 1 x 10: its ends have edges of length 1.
  auto bar = cube();
  for (auto& p : bar.points) p.z() *= 10;
  EXPECT_EQ(sharpCount(bar, {.angle = 30 * kDegree, .quadLength = 1, .shortest = 3}), 12);
}

TEST(FeatureGraph, theCubesEdgesMeetInEightJunctions) {
  MeshModelOptions options;
  options.features.sharp = FeatureOptions::Sharp::Align;
  const Model model = meshModel(cube(), options, Progress{});
  ASSERT_EQ(model.regions.size(), 1u);
  const auto graph = featureGraph(model.regions[0]);
  EXPECT_EQ(graph.curves.size(), 12u);
  EXPECT_EQ(graph.count(FeatureGraph::Node::Junction), 8);
  EXPECT_EQ(graph.count(FeatureGraph::Node::End), 0);
}

TEST(FeatureGraph, theOutlineOfARectangleHasFourCorners) {
  MeshModelOptions options;
  options.features.alignBoundary = true;
  const Model model = meshModel(flatSheet(6, 4), options, Progress{});
  const auto graph = featureGraph(model.regions[0]);
  EXPECT_EQ(graph.curves.size(), 4u);
  EXPECT_EQ(graph.count(FeatureGraph::Node::Corner), 4);
}

}  // namespace
}  // namespace trimquad
