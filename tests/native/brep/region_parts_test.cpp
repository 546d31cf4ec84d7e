#include "trimquad/brep/region_parts.h"

#include <array>
#include <map>
#include <numbers>
#include <optional>
#include <set>

#include "trimquad/brep/tessellate.h"
#include "trimquad/mesh/touching_regions.h"

// After OpenMesh: OpenCASCADE's macros must not reach the mesh headers.
#include <gtest/gtest.h>

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRep_Tool.hxx>
#include <Geom_BezierCurve.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>

namespace trimquad {
namespace {

using Eigen::Vector3d;

/// A box of 4 x 3 x 2 whose upright edges are rounded with radius 0.5: its side is one region of four planes
/// and four cylinders.
TopoDS_Shape roundedBox() {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(4, 3, 2).Shape();
  BRepFilletAPI_MakeFillet fillet(box);
  std::set<std::pair<double, double>> done;
  for (TopExp_Explorer edge(box, TopAbs_EDGE); edge.More(); edge.Next()) {
    const auto& e = TopoDS::Edge(edge.Current());
    double first, last;
    const auto curve = BRep_Tool::Curve(e, first, last);
    const gp_Pnt a = curve->Value(first), b = curve->Value(last);
    if (std::abs(a.Z() - b.Z()) > 1 && done.insert({a.X(), a.Y()}).second) fillet.Add(0.5, e);
  }
  return fillet.Shape();
}

/// Upper and lower side of a leading edge of radius `radius` along z, 1 deep, 2 long; the lower one in two
/// faces.
TopoDS_Shape leadingEdge(double radius) {
  const double height = std::sqrt(2 * radius);
  BRepBuilderAPI_Sewing sewing;
  const auto add = [&](double sign, double first, double last) {
    TColgp_Array1OfPnt poles(1, 3);
    poles(1) = gp_Pnt(0, 0, 0);
    poles(2) = gp_Pnt(0, sign * height / 2, 0);
    poles(3) = gp_Pnt(1, sign * height, 0);
    const TopoDS_Edge edge = BRepBuilderAPI_MakeEdge(new Geom_BezierCurve(poles), first, last);
    sewing.Add(BRepPrimAPI_MakePrism(edge, gp_Vec(0, 0, 2)).Shape());
  };
  add(1, 0, 1);
  add(-1, 0, 0.6);
  add(-1, 0.6, 1);
  sewing.Perform();
  return sewing.SewedShape();
}

Model tessellatedWhole(const TopoDS_Shape& shape,
                       FeatureOptions features = {.sharp = FeatureOptions::Sharp::Trim},
                       double tolerance = 0.01) {
  features.quadLength = 0.9;
  return tessellate(Shape(shape), {0.3, tolerance, features}, Progress());
}

/// The number of the region that is neither top nor bottom.
int side(const Model& model) {
  for (int r = 0; r < int(model.regions.size()); ++r) {
    const auto& mesh = model.regions[r].mesh;
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (const auto v : mesh.vertices())
      low = std::min(low, mesh.point(v).z()), high = std::max(high, mesh.point(v).z());
    if (high - low > 1) return r;
  }
  return -1;
}

/// Every boundary edge has its counterpart: on the same curve, between bitwise the same points, walked the
/// other way.
void expectWatertight(const Model& model) {
  using Place = std::array<double, 3>;
  std::map<std::tuple<int, Place, Place>, int> uses;
  for (const auto& region : model.regions)
    for (const auto h : region.mesh.halfedges()) {
      const auto curve = region.edgeCurve[region.mesh.edge_handle(h).idx()];
      EXPECT_EQ(curve.has_value(), region.mesh.is_boundary(region.mesh.edge_handle(h)));
      if (!region.mesh.is_boundary(h)) continue;
      const auto at = [&](VertexHandle v) {
        const Vector3d p = region.mesh.point(v);
        if (const auto& corner = region.corner[v.idx()]) {
          EXPECT_EQ(p, model.corners[corner->index]);
        }
        return Place{p.x(), p.y(), p.z()};
      };
      const Place a = at(region.mesh.from_vertex_handle(h)), b = at(region.mesh.to_vertex_handle(h));
      uses[{curve->index, std::min(a, b), std::max(a, b)}] += a < b ? 1 : 100;
    }
  for (const auto& [edge, count] : uses) EXPECT_EQ(count, 101);
}

double area(const Model& model) {
  double sum = 0;
  for (const auto& region : model.regions) sum += surfaceArea(region.mesh);
  return sum;
}

Model cutAt(const Model& model, int region, const std::optional<Vector3d>& place) {
  const auto parts = regionParts(model, region, {.point = place}, Progress());
  EXPECT_TRUE(parts);
  return withParts(model, {{region, &*parts}});
}

TEST(RegionParts, shareTheirBordersExactly) {
  const Model whole = tessellatedWhole(roundedBox());
  ASSERT_EQ(whole.regions.size(), 3u);
  const Model model = cutAt(whole, side(whole), {});
  ASSERT_EQ(model.regions.size(), 10u);
  expectWatertight(model);
  EXPECT_NEAR(area(model), area(whole), 0.01);
  for (const auto& region : model.regions) EXPECT_EQ(eulerCharacteristic(region.mesh), 1);
  ASSERT_EQ(model.shells.size(), 1u);
  EXPECT_EQ(model.shells[0].regions.size(), 10u);
  EXPECT_EQ(model.curves.size(), whole.curves.size() + 8);
  EXPECT_EQ(model.regions[side(whole) + 2].name, whole.regions[side(whole)].name + ".3");
}

TEST(RegionParts, aPlaceCutsOutTheFaceThere) {
  const Model whole = tessellatedWhole(roundedBox());
  const int cut = side(whole);
  const auto parts = regionParts(
      whole, cut, {.point = Vector3d(0.5 - 0.5 / std::sqrt(2), 0.5 - 0.5 / std::sqrt(2), 1)}, Progress());
  ASSERT_TRUE(parts);
  EXPECT_EQ(parts->edges.size(), 2u);
  ASSERT_EQ(parts->model.regions.size(), 2u);
  const Model model = withParts(whole, {{cut, &*parts}});
  expectWatertight(model);
  const double fillet =
      std::min(surfaceArea(model.regions[cut].mesh), surfaceArea(model.regions[cut + 1].mesh));
  EXPECT_NEAR(fillet, 0.5 * std::numbers::pi / 2 * 2, 0.01);
}

TEST(RegionParts, creasesAreWhereTheSurfaceBendsWithinAnEdge) {
  for (const bool sharp : {true, false}) {
    const Model whole =
        tessellatedWhole(leadingEdge(sharp ? 0.002 : 0.2), {.sharp = FeatureOptions::Sharp::Trim}, 0.04);
    ASSERT_EQ(whole.regions.size(), 1u);
    EXPECT_TRUE(whole.regions[0].aligned.empty());
    const auto parts = regionParts(whole, 0, {.creases = true}, Progress());
    ASSERT_EQ(parts.has_value(), sharp);
    if (!sharp) continue;
    for (const auto& part : parts->model.regions) EXPECT_FALSE(part.aligned.empty());
    EXPECT_EQ(parts->edges.size(), 1u);
    ASSERT_EQ(parts->model.regions.size(), 2u);
    // Upper and lower side.
    EXPECT_NEAR(surfaceArea(parts->model.regions[0].mesh), surfaceArea(parts->model.regions[1].mesh), 0.01);
    const Model model = withParts(whole, {{0, &*parts}});
    for (const int side : {0, 1}) EXPECT_FALSE(regionParts(model, side, {.creases = true}, Progress()));
    EXPECT_NE(regionParts(model, 0, {}, Progress()).has_value(),
              regionParts(model, 1, {}, Progress()).has_value());  // the lower side is of two faces
  }
}

TEST(RegionParts, trianglesBesideCreasesAreNoSlivers) {
  // At the tip the radius is below the tolerance, and far below the length of edges.
  const Model whole = tessellatedWhole(leadingEdge(0.002));
  ASSERT_EQ(whole.regions.size(), 1u);
  const auto& mesh = whole.regions[0].mesh;
  double worst = 1, onTip = 0;
  for (const auto f : mesh.faces()) {
    const auto h = mesh.halfedge_handle(f);
    const Vector3d a = mesh.calc_edge_vector(h), b = mesh.calc_edge_vector(mesh.next_halfedge_handle(h));
    const double sides = a.squaredNorm() + b.squaredNorm() + (a + b).squaredNorm();
    // The ends are curves of the model, which are divided without regard to the surface.
    const double z = mesh.calc_face_centroid(f).z();
    if (z > 0.1 && z < 1.9) worst = std::min(worst, 2 * std::sqrt(3) * a.cross(b).norm() / sides);
  }
  for (const auto e : mesh.edges()) {
    const auto h = mesh.halfedge_handle(e, 0);
    const Vector3d a = mesh.point(mesh.from_vertex_handle(h)), b = mesh.point(mesh.to_vertex_handle(h));
    if (std::max(std::abs(a.x()), std::abs(b.x())) < 1e-9) onTip += std::abs(a.z() - b.z());
  }
  EXPECT_GT(worst, 0.2);
  EXPECT_NEAR(onTip, 2, 1e-9);
}

TEST(RegionParts, touchTheirNeighbours) {
  const Model whole = tessellatedWhole(roundedBox());
  EXPECT_EQ(touchingRegions(whole, side(whole)), (std::vector<int>{0, 1, 2}));
  const Model model = cutAt(whole, side(whole), {});
  // Of eight parts in a ring, each touches the next ones, top and bottom.
  EXPECT_EQ(touchingRegions(model, side(whole)).size(), 5u);
}

TEST(RegionParts, canBeCutAgain) {
  const Model whole = tessellatedWhole(roundedBox());
  const int cut = side(whole);
  const Model once = cutAt(whole, cut, Vector3d(2, 0, 1));
  ASSERT_EQ(once.regions.size(), 4u);
  const int rest =
      surfaceArea(once.regions[cut].mesh) > surfaceArea(once.regions[cut + 1].mesh) ? cut : cut + 1;
  const Model twice = cutAt(once, rest, {});
  ASSERT_EQ(twice.regions.size(), 10u);
  expectWatertight(twice);
  EXPECT_EQ(twice.regions[rest].name, once.regions[rest].name + ".1");
}

TEST(RegionParts, severalRegionsAreCutAtOnce) {
  const TopoDS_Shape cylinder = BRepPrimAPI_MakeCylinder(1, 2).Shape();
  const Model first = tessellatedWhole(roundedBox()), second = tessellatedWhole(cylinder);
  for (const Model* whole : {&first, &second}) {
    std::map<int, RegionParts> cuts;
    for (int r = 0; r < int(whole->regions.size()); ++r)
      if (auto parts = regionParts(*whole, r, {}, Progress())) cuts.emplace(r, std::move(*parts));
    std::map<int, const RegionParts*> all;
    for (const auto& [r, parts] : cuts) all[r] = &parts;
    ASSERT_EQ(all.size(), 1u);  // a plane face has nothing to be cut along
    expectWatertight(withParts(*whole, all));
  }
}

TEST(RegionParts, aFaceOfItsOwnOpensAlongItsSeam) {
  const Model whole = tessellatedWhole(BRepPrimAPI_MakeCylinder(1, 2).Shape());
  const int cut = side(whole);
  ASSERT_EQ(eulerCharacteristic(whole.regions[cut].mesh), 0);
  const Model model = cutAt(whole, cut, Vector3d(0, 1, 1));
  ASSERT_EQ(model.regions.size(), 3u);
  EXPECT_EQ(eulerCharacteristic(model.regions[cut].mesh), 1);
  expectWatertight(model);
  EXPECT_FALSE(regionParts(model, cut, {}, Progress()));
}

TEST(RegionParts, keepFeaturePointsAndAlignedEdges) {
  FeatureOptions features{.sharp = FeatureOptions::Sharp::Trim, .alignBoundary = true};
  features.points = {Vector3d(2, 0, 1), Vector3d(2, 0, 2)};
  const Model whole = tessellatedWhole(roundedBox(), features);
  const Model model = cutAt(whole, side(whole), {});
  expectWatertight(model);
  std::set<std::array<double, 3>> places;
  double aligned = 0;
  for (const auto& region : model.regions) {
    for (const auto v : region.featurePoints) {
      const auto p = region.mesh.point(v);
      places.insert({p.x(), p.y(), p.z()});
    }
    for (const auto e : region.aligned) aligned += region.mesh.calc_edge_length(e);
  }
  EXPECT_EQ(places.size(), 2u);
  // Top and bottom from both sides; smooth edges along which a region was cut are not aligned.
  EXPECT_NEAR(aligned, 4 * (2 * 3 + 2 * 2 + std::numbers::pi), 0.1);
}

}  // namespace
}  // namespace trimquad
