#include "trimquad/field/field_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <optional>
#include <random>

#include "support/error_of.h"
#include "trimquad/mesh/mesh_model.h"

namespace trimquad {
namespace {

using Eigen::Vector3d;

class FieldFiles : public testing::Test {
 protected:
  FieldFiles()
      : folder_(std::filesystem::temp_directory_path() /
                ("trimquad_field_" + std::to_string(std::random_device{}()))) {
    std::filesystem::create_directory(folder_);
  }
  ~FieldFiles() override { std::filesystem::remove_all(folder_); }

  FieldFile read(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return readField(folder_ / name);
  }

  std::optional<Error> errorOf(const std::string& name, const std::string& text) const {
    return trimquad::errorOf([&] { read(name, text); });
  }

 private:
  std::filesystem::path folder_;
};

/// Two triangles of the unit square, and one that stands upright at its side x = 1.
MeshFile threeTriangles() {
  MeshFile mesh;
  mesh.soup.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0.5, 1}};
  mesh.soup.triangles = {{0, 1, 2}, {0, 2, 3}, {2, 1, 4}};
  mesh.face = {0, 1, 2};
  mesh.faceCount = 3;
  return mesh;
}

/// Whether two directions agree up to quarter turns about `normal`.
bool sameCross(const Vector3d& a, const Vector3d& b, const Vector3d& normal) {
  const double angle = std::atan2(a.cross(b).dot(normal), a.dot(b)) / (std::numbers::pi / 2);
  return std::abs(angle - std::round(angle)) < 1e-6;
}

TEST_F(FieldFiles, ourOwnFormatHasDirectionsWithOrWithoutWeights) {
  const auto field = read("a.txt", "# by face\n1 0 0\n0 2 0 0.5\n\n0 0 1 # upright\n");
  EXPECT_EQ(field.count(), 3);
  EXPECT_EQ(field.symmetry, 1);
  EXPECT_EQ(field.weight, (std::vector<double>{1, 0.5, 1}));
  EXPECT_TRUE(field.point.empty());
  const auto placed = read("b.txt", "0 0 0 1 0 0\n1 1 1 0 1 0 0.25\n");
  ASSERT_EQ(placed.point.size(), 2u);
  EXPECT_EQ(placed.point[1], Vector3d(1, 1, 1));
  EXPECT_EQ(placed.weight[1], 0.25);
}

TEST_F(FieldFiles, rawfieldsAndRosyFilesAreRead) {
  const auto raw = read("a.rawfield", "4 2\n1 0 0 0 1 0 -1 0 0 0 -1 0\n0 1 0 -1 0 0 0 -1 0 1 0 0 \n");
  EXPECT_EQ(raw.count(), 2);
  EXPECT_EQ(raw.symmetry, 4);
  EXPECT_EQ(raw.direction.size(), 8u);
  const auto rosy = read("a.rosy", "3\n4\n1 0 0\n0 1 0\n0 0 1\n");
  EXPECT_EQ(rosy.count(), 3);
  EXPECT_EQ(rosy.symmetry, 1);
}

TEST_F(FieldFiles, damageIsNamedWithItsLine) {
  struct Case {
    const char *name, *text, *where, *message;
  };
  for (const Case& c : {
           Case{"a.rawfield", "5 1\n1 0 0 0 1 0 1 1 0 1 2 0 0 0 1\n", "line 1", "no cross field"},
           Case{"a.rawfield", "1 3\n1 0 0\n0 1 0\n", "line 3", "announces 3 directions, but has 2"},
           Case{"a.rawfield", "1 1\n1 0 0 4\n", "line 2", "more than 1"},
           Case{"a.rawfield", "2 1\n1 0 0 4\n", "line 2", "missing"},
           Case{"a.rosy", "1\n6\n1 0 0\n", "line 2", "no cross field"},
           Case{"a.rosy", "2\n", "line 1", "missing"},
           Case{"a.txt", "1 0\n", "line 1", "2 numbers"},
           Case{"a.txt", "1 0 0\n0 0 0 1 0 0\n", "line 2", "some lines have a point"},
           Case{"a.txt", "1 0 0 2\n", "line 1", "between 0 and 1"},
           Case{"a.txt", "1 x 0\n", "line 1", "should be a number"},
           Case{"a.txt", "1 nan 0\n", "line 1", "finite"},
           Case{"a.txt", "# nothing\n", "line 1", "no directions"},
       }) {
    const auto error = errorOf(c.name, c.text);
    ASSERT_TRUE(error) << c.text;
    EXPECT_EQ(error->kind(), Error::Kind::Input);
    EXPECT_NE(error->where().find(c.where), std::string::npos) << error->what();
    EXPECT_NE(error->message().find(c.message), std::string::npos) << error->what();
  }
  EXPECT_THROW(readField("/no/such/file.rawfield"), Error);
}

TEST_F(FieldFiles, aWrongCountSaysWhatWouldBeRight) {
  const auto field = read("a.txt", "1 0 0\n0 1 0\n");
  try {
    triangleDirections(field, threeTriangles());
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(error.message().find("2 elements"), std::string::npos);
    EXPECT_NE(error.message().find("3 faces and 5 vertices"), std::string::npos);
  }
}

TEST_F(FieldFiles, directionsByFaceLieInTheTriangles) {
  const auto field = read("a.txt", "1 1 0\n0 3 5\n1 0 0\n");
  const auto found = triangleDirections(field, threeTriangles());
  EXPECT_TRUE(sameCross(found.direction[0], {1, 1, 0}, {0, 0, 1}));
  EXPECT_TRUE(sameCross(found.direction[1], {0, 1, 0}, {0, 0, 1}));
  EXPECT_NEAR(found.direction[1].norm(), 1, 1e-12);
  EXPECT_NEAR(found.weight[0], 1, 1e-12);
  EXPECT_EQ(found.weight[2], 0);  // upright on its triangle: says nothing
}

TEST_F(FieldFiles, aSkewFrameGivesTheCrossBetween) {
  const double a = 0.2, b = std::numbers::pi / 2 + 0.3;  // 0.2 and, a quarter turn back, 0.3
  std::string line;
  for (const double angle : {a, b, a + std::numbers::pi, b + std::numbers::pi})
    line += std::to_string(std::cos(angle)) + " " + std::to_string(std::sin(angle)) + " 0 ";
  const auto field = read("a.rawfield", "4 3\n" + line + "\n" + line + "\n" + line + "\n");
  const auto found = triangleDirections(field, threeTriangles());
  const double angle = std::atan2(found.direction[0].y(), found.direction[0].x());
  EXPECT_NEAR(std::remainder(angle - 0.25, std::numbers::pi / 2), 0, 1e-5);
  EXPECT_GT(found.weight[0], 0.9);
}

TEST_F(FieldFiles, directionsByVertexAreAveragedUpToQuarterTurns) {
  const auto field = read("a.txt", "1 0 0\n0 1 0\n-1 0 0\n0 -1 0\n1 0 0\n");
  const auto found = triangleDirections(field, threeTriangles());
  for (const int t : {0, 1}) {
    EXPECT_TRUE(sameCross(found.direction[t], {1, 0, 0}, {0, 0, 1}));
    EXPECT_NEAR(found.weight[t], 1, 1e-12);
  }
}

TEST_F(FieldFiles, regionsGetTheDirectionsOfTheirOwnTriangles) {
  // Two sheets, the triangles of both mixed, and one aligned all around so that triangles are split.
  MeshFile mesh;
  mesh.soup.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {6, 1, 0}};
  mesh.soup.triangles = {{4, 5, 6}, {0, 1, 2}, {5, 7, 6}, {1, 3, 2}};
  mesh.face = {0, 1, 2, 3};
  mesh.faceCount = 4;
  const auto field = read("a.txt", "1 0.1 0\n1 0.2 0\n1 0.3 0\n1 0.4 0\n");
  const auto byTriangle = triangleDirections(field, mesh);
  const Model model = meshModel(mesh.soup, {.features = {.alignBoundary = true}}, Progress{});
  ASSERT_EQ(model.regions.size(), 2u);
  for (const auto& region : model.regions) {
    const auto guidance = guidanceOf(region, byTriangle);
    ASSERT_EQ(guidance.direction.size(), region.mesh.n_faces());
    EXPECT_GT(region.mesh.n_faces(), 2u);
    for (const auto f : region.mesh.faces()) {
      const Vector3d p = region.mesh.calc_face_centroid(f);
      const double x = p.x() > 4 ? p.x() - 5 : p.x();
      const double slope = (p.x() > 4 ? 0.1 : 0.2) + (x + p.y() > 1 ? 0.2 : 0);
      EXPECT_TRUE(sameCross(guidance.direction[f.idx()], {1, slope, 0}, {0, 0, 1}));
    }
  }
}

TEST_F(FieldFiles, pointsGiveTheirDirectionToTheTrianglesNearby) {
  const auto mesh = threeTriangles();
  const Model model = meshModel(mesh.soup, {}, Progress{});
  const auto field = read("a.txt", "0.7 0.3 0 1 1 0\n0.3 0.7 0.1 0 1 4 0.5\n1 0.5 0.5 1 0 0\n");
  const auto guidance = guidanceOf(model.regions.at(0), field);
  EXPECT_TRUE(sameCross(guidance.direction[0], {1, 1, 0}, {0, 0, 1}));
  EXPECT_TRUE(sameCross(guidance.direction[1], {0, 1, 0}, {0, 0, 1}));
  EXPECT_EQ(guidance.weight[1], 0.5);
  EXPECT_EQ(guidance.weight[2], 0);
}

}  // namespace
}  // namespace trimquad
