#include "trimquad/mesh/mesh_model.h"

#include <algorithm>
#include <map>
#include <set>

#include "support/error_of.h"
#include "support/mesh_samples.h"

namespace trimquad {
namespace {

Model modelOf(const TriangleSoup& soup, const MeshModelOptions& options = {}) {
  return meshModel(soup, options, Progress{});
}

MeshModelOptions trimmedAt(double degrees) {
  return {.features = {.sharp = FeatureOptions::Sharp::Trim, .angle = degrees}};
}

std::set<std::string> curveNames(const Model& model) {
  std::set<std::string> names;
  for (const auto& curve : model.curves) names.insert(curve.name);
  return names;
}

/// What Model and Region promise: every boundary edge lies on a curve, every vertex at its parameter, every
/// loop has a corner, every corner is in its place, and curves begin and end in corners.
void expectConsistent(const Model& model) {
  for (const auto& curve : model.curves) {
    EXPECT_EQ(curve.curve->point(curve.curve->first()), model.corners[curve.start.index]);
    EXPECT_EQ(curve.curve->point(curve.curve->last()), model.corners[curve.end.index]);
  }
  for (const auto& region : model.regions) {
    const auto& mesh = region.mesh;
    EXPECT_FALSE(region.surface);
    ASSERT_EQ(region.edgeCurve.size(), mesh.n_edges());
    ASSERT_EQ(region.corner.size(), mesh.n_vertices());
    ASSERT_EQ(region.curveParameter.size(), mesh.n_vertices());
    for (const auto e : mesh.edges()) EXPECT_EQ(region.edgeCurve[e.idx()].has_value(), mesh.is_boundary(e));
    for (const auto v : mesh.vertices())
      if (const auto corner = region.corner[v.idx()]) {
        EXPECT_EQ(mesh.point(v), model.corners[corner->index]);
      }
    for (const auto& loop : boundaryLoops(mesh)) {
      int corners = 0;
      for (const auto h : loop) {
        const auto v = mesh.to_vertex_handle(h);
        const auto curve = *region.edgeCurve[mesh.edge_handle(h).idx()];
        if (region.corner[v.idx()]) {
          ++corners;
          continue;
        }
        EXPECT_EQ(*region.edgeCurve[mesh.edge_handle(mesh.next_halfedge_handle(h)).idx()], curve);
        EXPECT_EQ(model.curves[curve.index].curve->point(region.curveParameter[v.idx()]), mesh.point(v));
      }
      EXPECT_GT(corners, 0);
    }
  }
}

TEST(MeshModel, aRectangleHasFourCurvesOfItsSidesLengths) {
  const Model model = modelOf(flatSheet(6, 4));
  expectConsistent(model);
  EXPECT_EQ(model.corners.size(), 4u);
  EXPECT_EQ(curveNames(model), std::set<std::string>{"loop:0"});
  std::multiset<double> lengths;
  for (const auto& curve : model.curves) lengths.insert(curve.curve->last() - curve.curve->first());
  EXPECT_EQ(lengths, (std::multiset<double>{4, 4, 6, 6}));
  EXPECT_DOUBLE_EQ(model.diagonal, std::sqrt(52));
}

TEST(MeshModel, theCoarsestSquareHasItsFourCorners) {
  const Model model = modelOf(flatSheet(1, 1));
  expectConsistent(model);
  EXPECT_EQ(model.corners.size(), 4u);
}

TEST(MeshModel, roundLoopsStartInTheirSmallestVertex) {
  const Model model = modelOf(band(40, 0));
  expectConsistent(model);
  EXPECT_EQ(curveNames(model), (std::set<std::string>{"loop:0", "loop:1"}));
  ASSERT_EQ(model.curves.size(), 2u);
  for (const auto& curve : model.curves) EXPECT_EQ(curve.start, curve.end);
  EXPECT_EQ(*model.regions[0].corner[0], model.curves[0].start);
  EXPECT_TRUE(model.regions[0].corner[1]);
}

TEST(MeshModel, teethOfAJaggedBoundaryAreNoCorners) {
  const int n = 40;
  const auto soup = sheet(n, 6, [&](double i, double j) {
    const double tooth = j == 6 && i > 4 && i < n - 4 && int(i) % 2 == 1 ? 0.6 : 0;
    return Eigen::Vector3d(i, j + tooth, 0);
  });
  const Model model = modelOf(soup);
  expectConsistent(model);
  EXPECT_EQ(model.corners.size(), 4u);
}

TEST(MeshModel, componentsBecomeRegionsAndClosedOnesSolids) {
  TriangleSoup soup = cube();
  const TriangleSoup patch = flatSheet(3, 3);
  for (const auto& p : patch.points) soup.points.push_back(p + Eigen::Vector3d(9, 0, 0));
  for (const auto& t : patch.triangles) soup.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
  const Model model = modelOf(soup);
  expectConsistent(model);
  ASSERT_EQ(model.regions.size(), 2u);
  EXPECT_EQ(model.regions[0].name, "component 0");
  EXPECT_EQ(model.regions[1].name, "component 1");
  ASSERT_EQ(model.shells.size(), 2u);
  EXPECT_EQ(model.shells[0].solid, 0);
  EXPECT_FALSE(model.shells[1].solid);
  EXPECT_EQ(model.curves.size(), 4u);
}

TEST(MeshModel, aCubeIsCutIntoItsFacesWhichShareTwelveEdges) {
  const Model model = modelOf(cube(), trimmedAt(30));
  expectConsistent(model);
  EXPECT_EQ(model.regions.size(), 6u);
  EXPECT_EQ(model.curves.size(), 12u);
  EXPECT_EQ(model.corners.size(), 8u);
  ASSERT_EQ(model.shells.size(), 1u);
  EXPECT_EQ(model.shells[0].regions, (std::vector<int>{0, 1, 2, 3, 4, 5}));
  std::map<int, int> uses;
  for (const auto& region : model.regions)
    for (const auto& curve : region.edgeCurve)
      if (curve) ++uses[curve->index];
  for (int c = 0; c < 12; ++c) EXPECT_EQ(uses[c], 2);
}

TEST(MeshModel, aRoofIsCutAlongItsRidgeWithTheSameVerticesOnBothSides) {
  const auto roof =
      sheet(8, 10, [](double i, double j) { return Eigen::Vector3d(i, j, 4 - std::abs(i - 4)); });
  const Model model = modelOf(roof, trimmedAt(30));
  expectConsistent(model);
  ASSERT_EQ(model.regions.size(), 2u);
  EXPECT_EQ(model.regions[0].name, "component 0 part 0");
  const auto ridge = std::find_if(model.curves.begin(), model.curves.end(),
                                  [](const ModelCurve& curve) { return curve.name == "feature:0"; });
  ASSERT_NE(ridge, model.curves.end());
  EXPECT_EQ(ridge->curve->last(), 10);
  const CurveId id{int(ridge - model.curves.begin())};
  std::vector<std::set<double>> parameters;
  for (const auto& region : model.regions) {
    auto& own = parameters.emplace_back();
    for (const auto e : region.mesh.edges()) {
      if (region.edgeCurve[e.idx()] != id) continue;
      for (int side = 0; side < 2; ++side) {
        const auto v = region.mesh.from_vertex_handle(region.mesh.halfedge_handle(e, side));
        if (!region.corner[v.idx()]) own.insert(region.curveParameter[v.idx()]);
      }
    }
  }
  EXPECT_EQ(parameters[0].size(), 9u);
  EXPECT_EQ(parameters[0], parameters[1]);
}

TEST(MeshModel, sharpEdgesThatEncloseNothingCutNothing) {
  // A ridge that rises from the middle of the sheet on.
  const auto soup = sheet(8, 16, [](double i, double j) {
    return Eigen::Vector3d(i, j, std::max(0.0, j - 6) / 3 * std::max(0.0, 1 - std::abs(i - 4) / 4));
  });
  EXPECT_EQ(modelOf(soup, trimmedAt(30)).regions.size(), 1u);
}

TEST(MeshModel, aVertexInWhichARegionTouchesItselfBecomesTwo) {
  // Two peaks whose feet meet in (3, 3) leave two flat triangles there, in opposite sectors.
  const auto soup = sheet(6, 6, [](double i, double j) {
    const bool peak = (i == 2 && j == 2) || (i == 4 && j == 4);
    return Eigen::Vector3d(i, j, peak ? 2 : 0);
  });
  const Model model = modelOf(soup, trimmedAt(30));
  expectConsistent(model);
  const auto& plain = model.regions[0];
  std::vector<CornerId> copies;
  for (const auto v : plain.mesh.vertices())
    if (plain.mesh.point(v) == Eigen::Vector3d(3, 3, 0)) copies.push_back(plain.corner[v.idx()].value());
  ASSERT_EQ(copies.size(), 2u);
  EXPECT_EQ(copies[0], copies[1]);
}

TEST(MeshModel, randomHeightFieldsKeepTheContractAndTheArea) {
  const unsigned seed = std::random_device{}();
  std::mt19937 random(seed);
  SCOPED_TRACE("seed " + std::to_string(seed));
  for (int round = 0; round < 60; ++round) {
    const auto soup =
        sheet(7, 7, [&](double i, double j) { return Eigen::Vector3d(i, j, double(random() % 3)); });
    const Model model = modelOf(soup, trimmedAt(20.0 + round));
    expectConsistent(model);
    double area = 0;
    for (const auto& region : model.regions) area += surfaceArea(region.mesh);
    EXPECT_NEAR(area, surfaceArea(buildSurfaceMesh(soup)), 1e-9);
  }
}

TEST(MeshModel, cancellingStopsIt) {
  Progress progress;
  progress.cancel();
  const auto error = errorOf([&] { meshModel(flatSheet(3, 3), {}, progress); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->kind(), Error::Kind::Cancelled);
}

}  // namespace
}  // namespace trimquad
