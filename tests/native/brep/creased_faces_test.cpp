#include "trimquad/brep/creased_faces.h"

#include <gtest/gtest.h>

// The mesh headers come first: OpenCASCADE's macros break them.
#include "trimquad/brep/cad_model.h"
#include "trimquad/brep/tessellate.h"

#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <Geom_BSplineSurface.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TopoDS_Face.hxx>
#include <set>

namespace trimquad {
namespace {

/// A sheet over polylines in the plane of x and z, from y = 0 to 2; of degree 1, so that it is of continuity
/// C0 at every inner point.
TopoDS_Face sheetOver(const std::vector<gp_Pnt>& line) {
  const int n = int(line.size());
  TColgp_Array2OfPnt poles(1, n, 1, 2);
  TColStd_Array1OfReal knots(1, n), ends(1, 2);
  TColStd_Array1OfInteger multiplicities(1, n), twice(1, 2);
  for (int i = 1; i <= n; ++i) {
    poles(i, 1) = line[i - 1];
    poles(i, 2) = line[i - 1].Translated(gp_Vec(0, 2, 0));
    knots(i) = i - 1;
    multiplicities(i) = i == 1 || i == n ? 2 : 1;
  }
  ends(1) = 0;
  ends(2) = 1;
  twice.Init(2);
  const Handle(Geom_BSplineSurface) surface =
      new Geom_BSplineSurface(poles, knots, ends, multiplicities, twice, 1, 1);
  return BRepBuilderAPI_MakeFace(surface, 1e-7).Face();
}

const std::vector<gp_Pnt> kFolded{{0, 0, 0}, {1, 0, 0}, {1, 0, 1.5}};

TEST(CreasedFaces, aSheetIsDividedWhereItIsFolded) {
  const CadModel model = cadModel(Shape(sheetOver(kFolded)), 0);
  ASSERT_EQ(model.faces.size(), 2u);
  EXPECT_EQ(model.edges.size(), 7u);  // the crease is shared
  for (const auto& face : model.faces) EXPECT_EQ(face.name, "Face1");
}

TEST(CreasedFaces, bothSidesOfACreaseAreRegions) {
  TessellateOptions options;
  options.edgeLength = 0.3;
  options.tolerance = 0.01;
  const Model model = tessellate(Shape(sheetOver(kFolded)), options, Progress());
  EXPECT_EQ(model.regions.size(), 2u);
}

/// Names are those of the input: an edge that was divided is all of its parts, and no part has the name of
/// another edge.
TEST(CreasedFaces, dividedEdgesKeepTheirNames) {
  const CadModel model = cadModel(Shape(sheetOver(kFolded)), 0);
  ASSERT_EQ(model.edgesNamed.size(), 4u);
  std::multiset<std::size_t> parts;
  std::set<int> seen;
  for (const auto& named : model.edgesNamed) {
    parts.insert(named.size());
    for (const int e : named) EXPECT_TRUE(seen.insert(e).second);
  }
  EXPECT_EQ(parts, (std::multiset<std::size_t>{1, 1, 2, 2}));
  std::multiset<std::string> names;
  for (const auto& edge : model.edges) names.insert(edge.name);
  for (const char* name : {"Edge1", "Edge2", "Edge3", "Edge4"}) EXPECT_LE(names.count(name), 2u) << name;
  EXPECT_EQ(names.count("Face1"), 1u);  // the crease, which is no edge of the input
}

/// Tangents that differ in length only, and bends of a few degrees, are no creases.
TEST(CreasedFaces, smoothSheetsStayWhole) {
  EXPECT_TRUE(dividedAtCreases(sheetOver({{0, 0, 0}, {1, 0, 0}, {3, 0, 0}})).shape.IsNull());
  EXPECT_TRUE(dividedAtCreases(sheetOver({{0, 0, 0}, {1, 0, 0}, {2, 0, 0.1}})).shape.IsNull());
  EXPECT_TRUE(dividedAtCreases(BRepPrimAPI_MakeBox(1, 2, 3).Shape()).shape.IsNull());
}

/// Neighbours share what becomes of their edge, which ends in a vertex on both sides where the crease meets
/// it.
TEST(CreasedFaces, neighboursStayConnected) {
  const TopoDS_Face sheet = sheetOver(kFolded);
  const CadModel model = cadModel(Shape(BRepPrimAPI_MakePrism(sheet, gp_Vec(0.5, 0, -0.5)).Shape()), 0);
  ASSERT_EQ(model.faces.size(), 8u);  // two sheets and two sides of two each, as swept from the crease
  EXPECT_EQ(model.edges.size(), 18u);
}

}  // namespace
}  // namespace trimquad
