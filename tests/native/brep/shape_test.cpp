#include "trimquad/brep/shape.h"

#include <gtest/gtest.h>

#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <STEPControl_Writer.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Shape.hxx>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "trimquad/base/error.h"
#include "trimquad/brep/occt_guard.h"

namespace trimquad {
namespace {

std::string file(const std::string& name, const std::string& content) {
  const auto path = std::filesystem::path(testing::TempDir()) / name;
  std::ofstream(path, std::ios::binary) << content;
  return path.string();
}

TopoDS_Shape box() {
  return BRepPrimAPI_MakeBox(1, 2, 3).Shape();
}

std::string brepText() {
  std::ostringstream text;
  BRepTools::Write(box(), text);
  return text.str();
}

std::string stepText() {
  QuietTranslators quiet;
  STEPControl_Writer writer;
  writer.Transfer(box(), STEPControl_AsIs);
  const auto path = file("written.step", "");
  writer.Write(path.c_str());
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

void expectRefused(const std::string& path) {
  try {
    readShape(path);
    FAIL() << path << " was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), Error::Kind::Input);
    EXPECT_EQ(error.stage(), "read");
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
  }
}

TEST(Shape, stepAndBRepGiveTheSameBox) {
  for (const auto& path : {file("box.STEP", stepText()), file("box.brep", brepText())}) {
    const Shape shape = readShape(path);
    EXPECT_EQ(shape.faceCount(), 6);
    EXPECT_EQ(shape.edgeCount(), 12);
    EXPECT_EQ(shape.solidCount(), 1);
    EXPECT_NEAR(shape.area(), 22, 1e-9);
    EXPECT_NEAR(shape.diagonal(), std::sqrt(14.0), 1e-5);
  }
}

TEST(Shape, freeCADBytesKeepTheShapeExactly) {
  const Shape shape(box());
  const std::string bytes = shapeToFreeCAD(shape);
  // The first reading clears the flags that say that the shape was checked.
  const std::string again = shapeToFreeCAD(shapeFromFreeCAD(bytes));
  EXPECT_EQ(again.size(), bytes.size());
  EXPECT_TRUE(shapeToFreeCAD(shapeFromFreeCAD(again)) == again);
  EXPECT_NEAR(shapeFromFreeCAD(bytes).area(), 22, 1e-12);
}

TEST(Shape, selectedFacesAreCountedFromOne) {
  EXPECT_EQ(Shape(box()).subShape({1, 3}).faceCount(), 2);
  EXPECT_EQ(Shape(box()).subShape({2}).edgeCount(), 4);
  EXPECT_THROW(Shape(box()).subShape({7}), Error);
  EXPECT_THROW(Shape(box()).subShape({0}), Error);
  EXPECT_THROW(Shape(box()).subShape({}), Error);
}

TEST(Shape, unusableFilesAreRefusedInOneLine) {
  const std::string step = stepText(), brep = brepText();
  expectRefused("/nowhere/box.step");
  expectRefused(testing::TempDir());
  expectRefused(file("unknown.txt", "hello"));
  for (const std::string extension : {".step", ".iges", ".brep"}) {
    expectRefused(file("empty" + extension, ""));
    expectRefused(file("garbage" + extension, "garbage\nwithout meaning\n"));
    expectRefused(file("binary" + extension, std::string("\0\1\2\377", 4)));
  }
  for (const int percent : {10, 40, 50, 60, 70, 80, 90, 97}) {
    expectRefused(file("cut.step", step.substr(0, step.size() * percent / 100)));
    expectRefused(file("cut.brep", brep.substr(0, brep.size() * percent / 100)));
  }
}

TEST(Shape, damagedFreeCADBytesAreRefused) {
  const std::string bytes = shapeToFreeCAD(Shape(box()));
  EXPECT_THROW(shapeFromFreeCAD(""), Error);
  EXPECT_THROW(shapeFromFreeCAD("garbage"), Error);
  EXPECT_THROW(shapeFromFreeCAD(bytes.substr(0, bytes.size() / 2)), Error);
}

TEST(Shape, shapesWithoutFacesAreRefused) {
  EXPECT_THROW(Shape{TopoDS_Shape()}, Error);
  TopoDS_Compound empty;
  BRep_Builder().MakeCompound(empty);
  EXPECT_THROW(Shape{empty}, Error);
}

}  // namespace
}  // namespace trimquad
