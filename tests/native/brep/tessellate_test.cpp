#include "trimquad/brep/tessellate.h"

#include <gtest/gtest.h>

// The mesh headers come first: OpenCASCADE's macros break them.
#include <BRepAdaptor_Curve.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRep_Builder.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>

#include "trimquad/base/error.h"
#include "trimquad/mesh/aabb_tree.h"

namespace trimquad {
namespace {

using Eigen::Vector3d;

Model tessellated(const TopoDS_Shape& shape, double edgeLength, double tolerance = 0.02) {
  TessellateOptions options;
  options.edgeLength = edgeLength;
  options.tolerance = tolerance;
  return tessellate(Shape(shape), options, Progress());
}

double signedVolume(const Model& model) {
  double volume = 0;
  for (const auto& region : model.regions)
    for (const auto f : region.mesh.faces()) {
      const auto h = region.mesh.halfedge_handle(f);
      const Vector3d a = region.mesh.point(region.mesh.from_vertex_handle(h)),
                     b = region.mesh.point(region.mesh.to_vertex_handle(h)),
                     c = region.mesh.point(region.mesh.to_vertex_handle(region.mesh.next_halfedge_handle(h)));
      volume += a.dot(b.cross(c)) / 6;
    }
  return volume;
}

/// The boundary vertices of a region on each curve, as sorted coordinates.
std::vector<std::vector<std::tuple<double, double, double>>> verticesByCurve(const Model& model,
                                                                             const Region& region) {
  std::vector<std::vector<std::tuple<double, double, double>>> result(model.curves.size());
  for (const auto e : region.mesh.edges()) {
    if (!region.edgeCurve[e.idx()]) continue;
    for (const int side : {0, 1}) {
      const Vector3d& p =
          region.mesh.point(region.mesh.to_vertex_handle(region.mesh.halfedge_handle(e, side)));
      result[region.edgeCurve[e.idx()]->index].emplace_back(p.x(), p.y(), p.z());
    }
  }
  for (auto& points : result) {
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
  }
  return result;
}

/// What tessellate promises of every model.
void expectValid(const Model& model) {
  std::vector<std::vector<std::tuple<double, double, double>>> onCurve(model.curves.size());
  for (const auto& region : model.regions) {
    const auto& mesh = region.mesh;
    for (const auto e : mesh.edges()) EXPECT_EQ(mesh.is_boundary(e), region.edgeCurve[e.idx()].has_value());
    for (const auto v : mesh.vertices()) {
      const Vector3d p = mesh.point(v);
      EXPECT_LT((region.surface->closest(p).point - p).norm(), 1e-9 * model.diagonal);
      if (region.corner[v.idx()]) {
        EXPECT_EQ(p, model.corners[region.corner[v.idx()]->index]);
      }
    }
    for (const auto f : mesh.faces()) {
      Vector3d normal = Vector3d::Zero();
      int boundary = 0;
      for (auto v = mesh.cfv_begin(f); v.is_valid(); ++v) {
        normal += region.surface->closest(mesh.point(*v)).normal;
        boundary += mesh.is_boundary(*v);
      }
      EXPECT_GT(mesh.calc_face_normal(f).dot(normal), 0);
      EXPECT_LT(boundary, 3);
    }
    const auto points = verticesByCurve(model, region);
    for (size_t c = 0; c < points.size(); ++c) {
      if (points[c].empty()) continue;
      if (onCurve[c].empty()) onCurve[c] = points[c];
      EXPECT_EQ(onCurve[c], points[c]) << model.curves[c].name;
    }
  }
}

/// Loose faces, from the corners of each.
TopoDS_Compound looseFaces(const std::vector<std::vector<gp_Pnt>>& faces) {
  TopoDS_Compound compound;
  BRep_Builder builder;
  builder.MakeCompound(compound);
  for (const auto& corners : faces) {
    BRepBuilderAPI_MakePolygon polygon;
    for (const auto& p : corners) polygon.Add(p);
    polygon.Close();
    builder.Add(compound, BRepBuilderAPI_MakeFace(polygon.Wire()).Face());
  }
  return compound;
}

TEST(Tessellate, looseFacesThatMakeUpNoSurfaceStayApart) {
  const gp_Pnt a(0, 0, 0), b(1, 0, 0);
  const Model joined =
      tessellated(looseFaces({{a, b, {1, 1, 0}, {0, 1, 0}}, {b, a, {0, -1, 0}, {1, -1, 0}}}), 0.2);
  EXPECT_FALSE(joined.keptApart);
  EXPECT_EQ(joined.regions.size(), 1);
  // Five triangles around a Moebius strip.
  const std::array<gp_Pnt, 5> p{a, b, gp_Pnt(0, 1, 0), gp_Pnt(0, 0, 1), gp_Pnt(1, 1, 1)};
  std::vector<std::vector<gp_Pnt>> strip;
  for (int i = 0; i < 5; ++i) strip.push_back({p[i], p[(i + 1) % 5], p[(i + 2) % 5]});
  const Model apart = tessellated(looseFaces(strip), 0.2);
  EXPECT_TRUE(apart.keptApart);
  EXPECT_EQ(apart.regions.size(), 5);
}

TEST(Tessellate, boxHasSixRegionsAndTwelveSharedCurves) {
  const Model model = tessellated(BRepPrimAPI_MakeBox(1, 2, 3).Shape(), 0.3);
  expectValid(model);
  EXPECT_EQ(model.regions.size(), 6u);
  EXPECT_EQ(model.curves.size(), 12u);
  EXPECT_EQ(model.corners.size(), 8u);
  ASSERT_EQ(model.shells.size(), 1u);
  EXPECT_EQ(model.shells[0].solid, 0);
  EXPECT_NEAR(signedVolume(model), 6, 1e-9);
  EXPECT_NEAR(model.diagonal, std::sqrt(14.0), 1e-9);
  std::vector<int> uses(12, 0);
  for (const auto& region : model.regions) {
    EXPECT_EQ(eulerCharacteristic(region.mesh), 1);
    const auto points = verticesByCurve(model, region);
    for (size_t c = 0; c < 12; ++c) uses[c] += !points[c].empty();
  }
  EXPECT_EQ(uses, std::vector<int>(12, 2));
}

TEST(Tessellate, edgesAreNamedAsFreeCADCountsThem) {
  const Shape box(BRepPrimAPI_MakeBox(1, 2, 3).Shape());
  const Model whole = tessellate(box, {0.3, 0.02}, Progress());
  const Model part = tessellate(box.subShape({4}), {0.3, 0.02}, Progress());
  ASSERT_EQ(part.curves.size(), 4u);
  for (const auto& curve : part.curves) {
    const auto same = std::find_if(whole.curves.begin(), whole.curves.end(),
                                   [&](const ModelCurve& c) { return c.name == curve.name; });
    ASSERT_NE(same, whole.curves.end());
    const auto middle = [](const ModelCurve& c) {
      return c.curve->point(0.5 * (c.curve->first() + c.curve->last()));
    };
    EXPECT_NEAR((middle(*same) - middle(curve)).norm(), 0, 1e-12);
  }
}

TEST(Tessellate, cylinderIsClosedAcrossItsSeam) {
  const Model model = tessellated(BRepPrimAPI_MakeCylinder(1, 2).Shape(), 0.2);
  expectValid(model);
  ASSERT_EQ(model.regions.size(), 3u);
  EXPECT_EQ(model.curves.size(), 2u);
  std::vector<int> euler;
  for (const auto& region : model.regions) euler.push_back(eulerCharacteristic(region.mesh));
  std::sort(euler.begin(), euler.end());
  EXPECT_EQ(euler, (std::vector<int>{0, 1, 1}));
  EXPECT_NEAR(signedVolume(model), 2 * std::numbers::pi, 0.15);
}

TEST(Tessellate, sphereIsOneClosedRegion) {
  const Model model = tessellated(BRepPrimAPI_MakeSphere(1).Shape(), 0.2);
  expectValid(model);
  ASSERT_EQ(model.regions.size(), 1u);
  EXPECT_TRUE(model.curves.empty());
  EXPECT_EQ(eulerCharacteristic(model.regions[0].mesh), 2);
  const auto c = model.regions[0].surface->curvature({0.6, 0, 0.8});
  EXPECT_NEAR(std::abs(c.k1), 1, 1e-9);
  EXPECT_NEAR(c.k1, c.k2, 1e-9);
}

TEST(Tessellate, torusIsOneClosedRegionOfGenusOne) {
  const Model model = tessellated(BRepPrimAPI_MakeTorus(3, 1).Shape(), 0.4);
  expectValid(model);
  ASSERT_EQ(model.regions.size(), 1u);
  EXPECT_EQ(eulerCharacteristic(model.regions[0].mesh), 0);
  EXPECT_GT(signedVolume(model), 0);
}

TEST(Tessellate, coneHasItsApexInside) {
  const Model model = tessellated(BRepPrimAPI_MakeCone(1, 0, 2).Shape(), 0.2);
  ASSERT_EQ(model.regions.size(), 2u);
  EXPECT_EQ(model.curves.size(), 1u);
  for (const auto& region : model.regions) EXPECT_EQ(eulerCharacteristic(region.mesh), 1);
  EXPECT_NEAR(signedVolume(model), 2 * std::numbers::pi / 3, 0.1);
}

TEST(Tessellate, smoothEdgesDoNotEndRegions) {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(4, 4, 4).Shape();
  BRepFilletAPI_MakeFillet rounded(box);
  for (TopExp_Explorer e(box, TopAbs_EDGE); e.More(); e.Next()) {
    const BRepAdaptor_Curve curve(TopoDS::Edge(e.Current()));
    if (std::abs(curve.Value(curve.FirstParameter()).Z() - curve.Value(curve.LastParameter()).Z()) > 1)
      rounded.Add(1, TopoDS::Edge(e.Current()));
  }
  const Model model = tessellated(rounded.Shape(), 0.4);
  expectValid(model);
  ASSERT_EQ(model.regions.size(), 3u);
  EXPECT_EQ(model.curves.size(), 16u);
  std::vector<size_t> loops;
  for (const auto& region : model.regions) loops.push_back(boundaryLoops(region.mesh).size());
  std::sort(loops.begin(), loops.end());
  EXPECT_EQ(loops, (std::vector<size_t>{1, 1, 2}));
}

TEST(Tessellate, holesStayHoles) {
  const TopoDS_Shape drill =
      BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(2, 2, -1), gp_Dir(0, 0, 1)), 0.5, 4).Shape();
  const Model model = tessellated(BRepAlgoAPI_Cut(BRepPrimAPI_MakeBox(4, 4, 1).Shape(), drill).Shape(), 0.4);
  expectValid(model);
  EXPECT_EQ(model.regions.size(), 7u);
  int annuli = 0;
  for (const auto& region : model.regions) annuli += eulerCharacteristic(region.mesh) == 0;
  EXPECT_EQ(annuli, 3);  // top, bottom and the drilled wall
  EXPECT_NEAR(signedVolume(model), 16 - 0.25 * std::numbers::pi, 0.05);
}

TEST(Tessellate, reversedAndMovedSolidsPointOutward) {
  gp_Trsf move;
  move.SetRotation(gp_Ax1(gp_Pnt(1, 0, 0), gp_Dir(1, 1, 1)), 0.7);
  const TopoDS_Shape moved = BRepPrimAPI_MakeBox(1, 2, 3).Shape().Moved(TopLoc_Location(move));
  EXPECT_NEAR(signedVolume(tessellated(moved, 0.5)), 6, 1e-9);
  EXPECT_NEAR(signedVolume(tessellated(moved.Reversed(), 0.5)), 6, 1e-9);
  gp_Trsf mirror;
  mirror.SetMirror(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(1, 0, 0)));
  const TopoDS_Shape mirrored =
      BRepBuilderAPI_Transform(BRepPrimAPI_MakeCylinder(1, 2).Shape(), mirror, true).Shape();
  const Model model = tessellated(mirrored, 0.3);
  expectValid(model);
  EXPECT_GT(signedVolume(model), 6);
}

TEST(Tessellate, trianglesDoNotReachAcrossARoundingSmallerThanThemselves) {
  constexpr double radius = 0.02;
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(2, 2, 1).Shape();
  BRepFilletAPI_MakeFillet fillet(box);
  for (TopExp_Explorer edge(box, TopAbs_EDGE); edge.More(); edge.Next()) {
    const BRepAdaptor_Curve curve(TopoDS::Edge(edge.Current()));
    if (std::abs(curve.Line().Direction().Z()) > 0.5) fillet.Add(radius, TopoDS::Edge(edge.Current()));
  }
  const Model model = tessellated(fillet.Shape(), 0.3, 0.01);
  ASSERT_EQ(model.regions.size(), 3u);
  // The walls are flat up to the rounding: a triangle that reached across would lie inside the box.
  for (const auto& region : model.regions)
    for (const auto f : region.mesh.faces()) {
      const Vector3d c = region.mesh.calc_face_centroid(f);
      const double inside = std::min({c.x(), 2 - c.x(), c.y(), 2 - c.y(), c.z(), 1 - c.z()});
      EXPECT_LT(inside, 2 * radius);
    }
}

TEST(Tessellate, theLipOfAThinPlateIsNotCutOff) {
  // Rounded all around its rim with half its thickness: the lip is much narrower than the triangles.
  constexpr double radius = 0.02, tolerance = 0.004;
  const TopoDS_Shape plate = BRepPrimAPI_MakeBox(1.6, 1.6, 2.2 * radius).Shape();
  BRepFilletAPI_MakeFillet fillet(plate);
  for (TopExp_Explorer edge(plate, TopAbs_EDGE); edge.More(); edge.Next()) {
    const BRepAdaptor_Curve curve(TopoDS::Edge(edge.Current()));
    if (std::abs(curve.Line().Direction().X()) > 0.5) fillet.Add(radius, TopoDS::Edge(edge.Current()));
  }
  const Model model = tessellated(fillet.Shape(), 0.5, tolerance);
  std::vector<Vector3d> points;
  std::vector<std::array<int, 3>> triangles;
  for (const auto& region : model.regions)
    for (const auto f : region.mesh.faces()) {
      triangles.push_back({int(points.size()), int(points.size()) + 1, int(points.size()) + 2});
      for (const auto v : region.mesh.fv_range(f)) points.push_back(region.mesh.point(v));
    }
  const TriangleTree tree(points, triangles);
  double worst = 0;
  for (double x = 0.3; x < 1.4; x += 0.012)
    worst = std::max(worst, tree.closest({x, 0, 1.1 * radius}).squaredDistance);
  EXPECT_LT(std::sqrt(worst), 1.2 * tolerance);
}

TEST(Tessellate, facesThatOnlyTouchAreSewn) {
  TopoDS_Compound faces;
  BRep_Builder builder;
  builder.MakeCompound(faces);
  for (const double y : {0.0, 1.0})
    builder.Add(faces, BRepBuilderAPI_MakeFace(gp_Pln(gp_Pnt(0, y, 0), gp_Dir(0, 0, 1)), 0, 1, 0, 1).Face());
  const Model model = tessellated(faces, 0.2);
  expectValid(model);
  ASSERT_EQ(model.regions.size(), 1u);
  EXPECT_NEAR(surfaceArea(model.regions[0].mesh), 2, 1e-9);
}

TEST(Tessellate, sharpEdgesCanBeIgnored) {
  TessellateOptions options;
  options.edgeLength = 0.3;
  options.features.sharp = FeatureOptions::Sharp::Ignore;
  const Model model = tessellate(Shape(BRepPrimAPI_MakeBox(1, 2, 3).Shape()), options, Progress());
  ASSERT_EQ(model.regions.size(), 1u);
  EXPECT_EQ(eulerCharacteristic(model.regions[0].mesh), 2);
}

TEST(Tessellate, sameInputGivesTheSameMesh) {
  const TopoDS_Shape shape = BRepPrimAPI_MakeCone(2, 1, 2).Shape();
  const Model a = tessellated(shape, 0.2), b = tessellated(shape, 0.2);
  ASSERT_EQ(a.regions.size(), b.regions.size());
  for (size_t r = 0; r < a.regions.size(); ++r) {
    ASSERT_EQ(a.regions[r].mesh.n_vertices(), b.regions[r].mesh.n_vertices());
    for (const auto v : a.regions[r].mesh.vertices())
      EXPECT_EQ(a.regions[r].mesh.point(v), b.regions[r].mesh.point(v));
  }
}

TEST(Tessellate, unusableOptionsAreRefused) {
  const Shape box(BRepPrimAPI_MakeBox(1, 2, 3).Shape());
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinite = std::numeric_limits<double>::infinity();
  for (const double bad : {0.0, -1.0, nan, infinite}) {
    EXPECT_THROW(tessellate(box, {bad, 0.1, {}}, Progress()), Error);
    EXPECT_THROW(tessellate(box, {0.1, bad, {}}, Progress()), Error);
    EXPECT_THROW(tessellate(box, {0.1, 0.1, {.angle = bad}}, Progress()), Error);
  }
}

TEST(Tessellate, threeFacesAtAnEdgeAreRefusedByName) {
  TopoDS_Compound solids;
  BRep_Builder builder;
  builder.MakeCompound(solids);
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(1, 1, 1).Shape();
  builder.Add(solids, box);
  // A fin on one of the box's own edges.
  const TopoDS_Edge edge = TopoDS::Edge(TopExp_Explorer(box, TopAbs_EDGE).Current());
  const BRepAdaptor_Curve curve(edge);
  const gp_Pnt a = curve.Value(curve.FirstParameter()), b = curve.Value(curve.LastParameter());
  const gp_Vec out(gp_Pnt(0.5, 0.5, 0.5), gp_Pnt((a.XYZ() + b.XYZ()) / 2));
  const TopoDS_Vertex va = TopExp::FirstVertex(edge), vb = TopExp::LastVertex(edge);
  BRepBuilderAPI_MakePolygon rest(vb, BRepBuilderAPI_MakeVertex(b.Translated(out)),
                                  BRepBuilderAPI_MakeVertex(a.Translated(out)));
  rest.Add(va);
  BRepBuilderAPI_MakeWire wire(edge);
  wire.Add(rest.Wire());
  builder.Add(solids, BRepBuilderAPI_MakeFace(wire.Wire(), true).Face());
  try {
    tessellated(solids, 0.2);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), Error::Kind::Input);
    EXPECT_EQ(error.where(), "Edge1");
  }
}

}  // namespace
}  // namespace trimquad
