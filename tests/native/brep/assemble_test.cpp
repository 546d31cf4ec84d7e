#include "trimquad/brep/assemble.h"

// Before OpenCASCADE, whose macro Handle() breaks OpenMesh.
#include "support/trim_samples.h"

#include <gtest/gtest.h>
#include <unistd.h>
#include <BRepGProp.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <ShapeAnalysis_FreeBounds.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Vertex.hxx>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

using namespace test;

int count(const Shape& shape, TopAbs_ShapeEnum type) {
  TopTools_IndexedMapOfShape map;
  TopExp::MapShapes(shape.topology(), type, map);
  return map.Extent();
}

double largestTolerance(const Shape& shape) {
  double tolerance = 0;
  TopTools_IndexedMapOfShape edges, vertices;
  TopExp::MapShapes(shape.topology(), TopAbs_EDGE, edges);
  TopExp::MapShapes(shape.topology(), TopAbs_VERTEX, vertices);
  for (int i = 1; i <= edges.Extent(); ++i)
    tolerance = std::max(tolerance, BRep_Tool::Tolerance(TopoDS::Edge(edges(i))));
  for (int i = 1; i <= vertices.Extent(); ++i)
    tolerance = std::max(tolerance, BRep_Tool::Tolerance(TopoDS::Vertex(vertices(i))));
  return tolerance;
}

int freeWires(const Shape& shape) {
  // Without a tolerance: with one it would sew first.
  const ShapeAnalysis_FreeBounds bounds(shape.topology());
  TopTools_IndexedMapOfShape wires;
  if (!bounds.GetClosedWires().IsNull()) TopExp::MapShapes(bounds.GetClosedWires(), TopAbs_WIRE, wires);
  if (!bounds.GetOpenWires().IsNull()) TopExp::MapShapes(bounds.GetOpenWires(), TopAbs_WIRE, wires);
  return wires.Extent();
}

double volume(const Shape& shape) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape.topology(), properties, 1e-6);
  return properties.Mass();
}

class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& ending) {
    static int number = 0;
    path_ = (std::filesystem::temp_directory_path() /
             ("trimquad_assemble_" + std::to_string(::getpid()) + "_" + std::to_string(number++) + ending))
                .string();
  }
  ~TemporaryFile() { std::filesystem::remove(path_); }
  const std::string& path() const { return path_; }
  std::string text() const {
    std::ifstream file(path_, std::ios::binary);
    std::stringstream all;
    all << file.rdbuf();
    return all.str();
  }

 private:
  std::string path_;
};

struct Expected {
  int faces, edges, vertices, freeWires;
};

/// Valid, without faults, with tolerances of 1e-7, before and after a journey through STEP.
Shape expectSound(TrimCase& trimCase, const Expected& expected) {
  const Shape shape = assemble(trimCase.trim());
  const TemporaryFile step(".step");
  writeStep(shape, step.path());
  const Shape read = readShape(step.path());
  for (const Shape* s : {&shape, &read}) {
    const std::string which = s == &shape ? "assembled" : "read from STEP";
    EXPECT_EQ(faults(*s), std::vector<std::string>{}) << which;
    EXPECT_LE(largestTolerance(*s), 1.001e-7) << which;
    EXPECT_EQ(count(*s, TopAbs_FACE), expected.faces) << which;
    EXPECT_EQ(count(*s, TopAbs_EDGE), expected.edges) << which;
    EXPECT_EQ(count(*s, TopAbs_VERTEX), expected.vertices) << which;
    EXPECT_EQ(freeWires(*s), expected.freeWires) << which;
  }
  return shape;
}

TEST(Assemble, rectangleSheet) {
  auto c = rectangleSheet();
  expectSound(c, {1, 4, 4, 1});
}

TEST(Assemble, roundSheetWithThreeHoles) {
  auto c = roundSheet();
  const Shape shape = expectSound(c, {1, 8, 8, 4});
  const double flat = std::numbers::pi * (25 - 1 - 0.49 - 1.21);
  EXPECT_GT(shape.area(), flat);
  EXPECT_LT(shape.area(), 1.1 * flat);
}

TEST(Assemble, tubeWithWavyEnds) {
  auto c = tube({});
  expectSound(c, {1, 5, 4, 2});
}

TEST(Assemble, tubeWithHoles) {
  auto c = tube({{0.3, 5}, {9, 4}});
  expectSound(c, {1, 9, 8, 4});
}

TEST(Assemble, tubeWhoseSeamMeetsHoles) {
  std::vector<Eigen::Vector2d> ring;
  for (int i = 0; i < 12; ++i) ring.emplace_back(2 * i + 0.4, i % 2 ? 3.5 : 6);
  auto c = tube(ring, 1.3);
  const Shape shape = assemble(c.trim());
  EXPECT_EQ(faults(shape), std::vector<std::string>{});
  EXPECT_EQ(freeWires(shape), 14);
}

TEST(Assemble, boxOfPlanes) {
  auto c = bulgedBox(0);
  const Shape shape = expectSound(c, {6, 12, 8, 0});
  EXPECT_EQ(shape.solidCount(), 1);
  EXPECT_NEAR(volume(shape), 480, 1e-6);
}

TEST(Assemble, bulgedBox) {
  auto c = bulgedBox(0.8);
  const Shape shape = expectSound(c, {6, 12, 8, 0});
  EXPECT_EQ(shape.solidCount(), 1);
  EXPECT_GT(volume(shape), 480);
}

TEST(Assemble, cornerOfThreeSheets) {
  auto c = bulgedBox(0.8, {1, 3, 5});
  expectSound(c, {3, 9, 7, 1});
}

TEST(Assemble, twoSheetsAtARightAngle) {
  auto c = bulgedBox(0.8, {1, 5});
  expectSound(c, {2, 7, 6, 1});
}

TEST(Assemble, filletedPlateWithAHole) {
  auto c = filletedPlate();
  // Eight circular or outline edges, two of each, and two seams.
  const Shape shape = expectSound(c, {4, 10, 8, 0});
  EXPECT_EQ(shape.solidCount(), 1);
  const double pi = std::numbers::pi;
  EXPECT_NEAR(volume(shape), 3 * (16 * 10 - (4 - pi) * 4 - pi * 2.25), 1.5);
}

TEST(Assemble, missingFaceLeavesAnOpenShell) {
  auto c = bulgedBox(0);
  c.fits[0].reset();
  const Shape shape = expectSound(c, {5, 12, 8, 1});
  EXPECT_EQ(shape.solidCount(), 0);
}

TEST(Assemble, aGapIsFound) {
  auto model = rectangleSheet().trim();
  for (auto& pole : model.edges[0].curve.poles) pole[2] += 1e-4;
  EXPECT_FALSE(faults(assemble(model)).empty());
}

TEST(WriteStep, sameShapeSameBytes) {
  const TemporaryFile first(".step"), second(".step");
  writeStep(assemble(roundSheet().trim()), first.path());
  writeStep(assemble(bulgedBox(0).trim()), second.path());
  writeStep(assemble(roundSheet().trim()), second.path());
  EXPECT_TRUE(first.text() == second.text());
  EXPECT_NE(first.text().find("AP242"), std::string::npos);
}

TEST(WriteStep, edgesOffTheirSurfacesAreReadAsTheyWereWritten) {
  auto model = bulgedBox(0.8).trim();
  constexpr double gap = 5e-7;
  auto& edge = model.edges[0];
  for (auto& pole : edge.curve.poles) pole[2] += gap;
  edge.curve.poles.front()[2] += gap / 4;  // where readers look
  for (double* tolerance : {&edge.tolerance, &model.vertices[edge.start.index].tolerance,
                            &model.vertices[edge.end.index].tolerance})
    *tolerance = 1.3 * gap;
  const Shape shape = assemble(model);
  ASSERT_EQ(faults(shape), std::vector<std::string>{});
  std::string text = stepText(shape);
  EXPECT_EQ(faults(shapeFromStep(text, "box")), std::vector<std::string>{});
  text.erase(std::remove(text.begin(), text.end(), '\n'), text.end());
  const std::string before = "UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(";
  EXPECT_GE(std::stod(text.substr(text.find(before) + before.size())), edge.tolerance);
}

TEST(WriteStep, unwritablePlacesAreInputErrors) {
  const Shape shape = assemble(rectangleSheet().trim());
  for (const auto write : {&writeStep, &writeBrep}) {
    for (const std::string path : {"/no/such/folder/x.step", "/dev/full"}) try {
        write(shape, path);
        ADD_FAILURE() << path;
      } catch (const Error& error) {
        EXPECT_EQ(error.kind(), Error::Kind::Input);
        EXPECT_EQ(error.where(), path);
      }
  }
}

TEST(WriteBrep, comesBackTheSame) {
  auto c = bulgedBox(0.8);
  const Shape shape = assemble(c.trim());
  const TemporaryFile brep(".brep");
  writeBrep(shape, brep.path());
  const Shape read = readShape(brep.path());
  EXPECT_EQ(faults(read), std::vector<std::string>{});
  EXPECT_EQ(count(read, TopAbs_EDGE), 12);
}

}  // namespace
}  // namespace trimquad
