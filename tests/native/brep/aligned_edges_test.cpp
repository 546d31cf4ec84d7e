#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <set>

#include "support/error_of.h"
#include "trimquad/base/error.h"
#include "trimquad/brep/tessellate.h"
#include "trimquad/mesh/feature_graph.h"

// After OpenMesh: OpenCASCADE's macros must not reach the mesh headers.
#include <gtest/gtest.h>

#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <TopoDS_Shape.hxx>

namespace trimquad {
namespace {

using Eigen::Vector3d;
using Node = FeatureGraph::Node;
using Sharp = FeatureOptions::Sharp;

Model tessellatedWith(const TopoDS_Shape& shape, FeatureOptions features, double edgeLength = 0.3) {
  features.quadLength = 3 * edgeLength;
  return tessellate(Shape(shape), {edgeLength, 0.02, features}, Progress());
}

double alignedLength(const Region& region) {
  double length = 0;
  for (const auto e : region.aligned) length += region.mesh.calc_edge_length(e);
  return length;
}

void expectPrepared(const Region& region) {
  const auto& mesh = region.mesh;
  const std::set<EdgeHandle> aligned(region.aligned.begin(), region.aligned.end());
  std::set<VertexHandle> held(region.featurePoints.begin(), region.featurePoints.end());
  for (const auto e : aligned)
    for (const int side : {0, 1}) held.insert(mesh.to_vertex_handle(mesh.halfedge_handle(e, side)));
  for (const auto f : mesh.faces()) {
    int corners = 0;
    for (const auto v : mesh.fv_range(f)) corners += int(held.count(v));
    EXPECT_LE(corners, 2);
  }
  for (const auto e : mesh.edges()) EXPECT_EQ(region.edgeCurve[e.idx()].has_value(), mesh.is_boundary(e));
  ASSERT_EQ(region.corner.size(), mesh.n_vertices());
  ASSERT_EQ(region.curveParameter.size(), mesh.n_vertices());
  for (const auto v : mesh.vertices()) {
    EXPECT_LT((region.surface->closest(mesh.point(v)).point - mesh.point(v)).norm(), 1e-6);
  }
}

TEST(AlignedCadEdges, aBoxIsOneClosedRegionWithTwelveCurves) {
  const Model model = tessellatedWith(BRepPrimAPI_MakeBox(1, 2, 3).Shape(), {.sharp = Sharp::Align});
  ASSERT_EQ(model.regions.size(), 1u);
  ASSERT_EQ(model.shells.size(), 1u);
  EXPECT_EQ(model.shells[0].regions, std::vector<int>{0});
  EXPECT_TRUE(model.curves.empty());
  const Region& region = model.regions[0];
  EXPECT_EQ(eulerCharacteristic(region.mesh), 2);
  EXPECT_NEAR(surfaceArea(region.mesh), 22, 1e-9);
  EXPECT_NEAR(alignedLength(region), 24, 1e-9);
  const auto graph = featureGraph(region);
  EXPECT_EQ(graph.curves.size(), 12u);
  EXPECT_EQ(graph.count(Node::Junction), 8);
  expectPrepared(region);
}

TEST(AlignedCadEdges, aCylinderHasTwoClosedCurves) {
  const Model model = tessellatedWith(BRepPrimAPI_MakeCylinder(1, 2).Shape(), {.sharp = Sharp::Align});
  ASSERT_EQ(model.regions.size(), 1u);
  const Region& region = model.regions[0];
  EXPECT_EQ(eulerCharacteristic(region.mesh), 2);
  EXPECT_NEAR(alignedLength(region), 4 * std::numbers::pi, 0.1);
  EXPECT_EQ(featureGraph(region).curves.size(), 2u);
  expectPrepared(region);
}

TEST(AlignedCadEdges, aSmoothEdgeCanBeChosen) {
  // The seam of a cylinder's side: one face on both of its hands.
  const TopoDS_Shape cylinder = BRepPrimAPI_MakeCylinder(1, 2).Shape();
  int seams = 0;
  for (const char* name : {"Edge1", "Edge2", "Edge3"}) {
    const Model model = tessellatedWith(cylinder, {.sharp = Sharp::Ignore, .align = {name}});
    ASSERT_EQ(model.regions.size(), 1u);
    const Region& region = model.regions[0];
    EXPECT_EQ(eulerCharacteristic(region.mesh), 2);
    const auto graph = featureGraph(region);
    ASSERT_EQ(graph.curves.size(), 1u) << name;
    if (graph.count(Node::End) == 2) {
      ++seams;
      EXPECT_NEAR(alignedLength(region), 2, 1e-9);
    }
    expectPrepared(region);
  }
  EXPECT_EQ(seams, 1);
}

TEST(AlignedCadEdges, inTrimModeChosenEdgesStayInsideAndBoundariesCanBeAligned) {
  const TopoDS_Shape cylinder = BRepPrimAPI_MakeCylinder(1, 2).Shape();
  const Model plain = tessellatedWith(cylinder, {.sharp = Sharp::Trim});
  const Model model = tessellatedWith(
      cylinder, {.sharp = Sharp::Trim, .alignBoundary = true, .align = {"Edge1", "Edge2", "Edge3"}});
  ASSERT_EQ(model.regions.size(), plain.regions.size());
  EXPECT_EQ(model.curves.size(), plain.curves.size());
  double length = 0;
  for (const auto& region : model.regions) {
    expectPrepared(region);
    length += alignedLength(region);
  }
  EXPECT_NEAR(length, 2 + 8 * std::numbers::pi, 0.2);
}

TEST(AlignedCadEdges, aFreedEdgeIsNoLongerAligned) {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(1, 1, 1).Shape();
  const Model model = tessellatedWith(box, {.sharp = Sharp::Align, .free = {"Edge1", "Edge2"}});
  EXPECT_NEAR(alignedLength(model.regions.at(0)), 10, 1e-9);
  const Model trimmed =
      tessellatedWith(box, {.sharp = Sharp::Trim, .alignBoundary = true, .free = {"Edge3"}});
  ASSERT_EQ(trimmed.regions.size(), 6u);
  double length = 0;
  for (const auto& region : trimmed.regions) length += alignedLength(region);
  EXPECT_NEAR(length, 22, 1e-9);
}

TEST(AlignedCadEdges, namesThatAreNotThereAreRefused) {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(1, 1, 1).Shape();
  for (const char* name : {"Edge13", "Edge0", "edge1", "Edge", "Edge1x", "Face1", ""}) {
    const auto error = errorOf([&] { tessellatedWith(box, {.align = {name}}); });
    ASSERT_TRUE(error) << name;
    EXPECT_EQ(error->kind(), Error::Kind::Input);
    EXPECT_EQ(error->stage(), "options");
    EXPECT_NE(error->message().find("Edge12"), std::string::npos);
  }
  EXPECT_TRUE(errorOf([&] { tessellatedWith(box, {.vertices = {"Vertex9"}}); }));
  // A pole of a sphere has an edge without length.
  const TopoDS_Shape sphere = BRepPrimAPI_MakeSphere(1).Shape();
  int refused = 0;
  for (const char* name : {"Edge1", "Edge2", "Edge3"})
    refused += errorOf([&] { tessellatedWith(sphere, {.align = {name}}); }).has_value();
  EXPECT_EQ(refused, 2);
}

TEST(CadFeaturePoints, verticesAndPointsBecomeVerticesWhereverTheyLie) {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(2, 2, 2).Shape();
  const std::vector<Vector3d> wanted{{0.83, 1.11, 2}, {2, 0.5, 0.77}, {2, 2, 0.61},
                                     {0, 0, 2},       {1.2, 0, 0},    {1.3, 0, 0}};
  for (const Sharp sharp : {Sharp::Trim, Sharp::Align, Sharp::Ignore}) {
    const Model model = tessellatedWith(box, {.sharp = sharp, .vertices = {"Vertex2"}, .points = wanted});
    std::vector<int> found(wanted.size(), 0);
    std::size_t all = 0;
    for (const auto& region : model.regions) {
      expectPrepared(region);
      all += region.featurePoints.size();
      for (const auto v : region.featurePoints)
        for (std::size_t i = 0; i < wanted.size(); ++i)
          found[i] += (region.mesh.point(v) - wanted[i]).norm() < 1e-9;
    }
    // In how many regions each point lies.
    const auto expected = sharp == Sharp::Trim ? std::vector{1, 1, 2, 3, 2, 2} : std::vector<int>(6, 1);
    EXPECT_EQ(found, expected);
    EXPECT_EQ(all, sharp == Sharp::Trim ? 14u : 7u);
  }
}

TEST(CadFeaturePoints, aPointInSpaceIsRefused) {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(2, 2, 2).Shape();
  const auto error = errorOf([&] { tessellatedWith(box, {.points = {{1, 1, 1}}}); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->kind(), Error::Kind::Input);
}

/// Planes around a common corner, folded by some 40 degrees along one edge and little along the others.
TopoDS_Shape foldedFan() {
  constexpr int count = 18;
  const auto rim = [&](int k) {
    const int turn = std::abs((k + count / 2) % count - count / 2);
    const double angle = 2 * std::numbers::pi * k / count, height = 0.9 * std::pow(1 - turn / 9., 2);
    return gp_Pnt(std::cos(angle), std::sin(angle), height);
  };
  BRepBuilderAPI_Sewing sewing;
  for (int k = 0; k < count; ++k) {
    BRepBuilderAPI_MakePolygon triangle(gp_Pnt(0, 0, 0), rim(k), rim((k + 1) % count), true);
    sewing.Add(BRepBuilderAPI_MakeFace(triangle.Wire()).Face());
  }
  sewing.Perform();
  return sewing.SewedShape();
}

TEST(AlignedEdges, sharpEdgesThatSeparateNothingAreAligned) {
  for (const auto sharp : {Sharp::Trim, Sharp::Align, Sharp::Ignore}) {
    const Model model = tessellatedWith(foldedFan(), {.sharp = sharp}, 0.1);
    ASSERT_EQ(model.regions.size(), 1u);
    EXPECT_NEAR(alignedLength(model.regions[0]), sharp == Sharp::Ignore ? 0 : std::hypot(1, 0.9), 1e-6);
  }
}

}  // namespace
}  // namespace trimquad
