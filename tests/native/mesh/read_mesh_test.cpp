#include "trimquad/mesh/read_mesh.h"

#include <locale>

#include "mesh_file_samples.h"
#include "support/error_of.h"
#include "support/mesh_samples.h"
#include "trimquad/mesh/polygon.h"

namespace trimquad {
namespace {

/// The error for a file; fails the test if there is none or if it is not the user's input that is to blame.
std::string complaint(const std::string& name, const std::string& bytes) {
  const auto error = errorOf([&] { readText(name, bytes); });
  EXPECT_TRUE(error) << name << " was read: " << bytes.substr(0, 200);
  if (!error) return {};
  EXPECT_EQ(error->kind(), Error::Kind::Input);
  EXPECT_EQ(std::string(error->what()).find('\n'), std::string::npos);
  EXPECT_NE(error->where().find(name), std::string::npos) << error->what();
  return error->what();
}

/// Whether `text` holds `part`, readable when it does not.
testing::AssertionResult holds(const std::string& text, const std::string& part) {
  if (text.find(part) != std::string::npos) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "\"" << text << "\" does not hold \"" << part << "\"";
}

TEST(ReadMesh, everyFormatGivesTheSameTriangles) {
  const TriangleSoup soup =
      sheet(5, 4, [](double x, double y) { return Eigen::Vector3d(x / 4, y / 8, x * y / 64); });
  for (const auto& [name, bytes] : sampleFiles(soup)) {
    const MeshFile file = readText(name, bytes);
    ASSERT_EQ(file.soup.triangles.size(), soup.triangles.size()) << name;
    EXPECT_EQ(file.soup.points.size(), soup.points.size()) << name;
    EXPECT_EQ(file.faceCount, int(soup.triangles.size())) << name;
    for (std::size_t t = 0; t < soup.triangles.size(); ++t)
      for (int k = 0; k < 3; ++k)
        EXPECT_EQ(file.soup.points[file.soup.triangles[t][k]], soup.points[soup.triangles[t][k]]) << name;
  }
}

TEST(ReadMesh, objCornersMayHaveTextureAndNormalAndCountBackwards) {
  const auto file = readText(
      "a.OBJ",
      "# comment\r\nmtllib x.mtl\r\no part\r\nv +0 0 0\r\nv 1 0 0 1.0\r\nv 1 1 0 .5 .5 .5\r\n"
      "vt 0 0\r\nvn 0 0 1\r\ng one\r\nf 1/1/1 2//1 3/1\r\ng two\r\nv 0 1 0\r\nf -4 -2 -1 # last\r\n");
  const std::vector<std::array<int, 3>> expected = {{0, 1, 2}, {0, 2, 3}};
  EXPECT_EQ(file.soup.triangles, expected);
}

TEST(ReadMesh, objLinesMayBeContinuedAndKeepTheirNumbers) {
  EXPECT_EQ(readText("a.obj", "v 0 0 0\nv 1 0 \\\n0\nv 0 1 0\nf 1 \\\n 2 3\n").soup.triangles.size(), 1u);
  EXPECT_TRUE(holds(complaint("b.obj", "v 0 0 0\nv 1 0 \\\n0\nv 0 1 0\nf 1 2 9\n"), "line 5"));
}

TEST(ReadMesh, unusedVerticesAreKept) {
  EXPECT_EQ(readText("a.obj", "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 2 3 4\n").soup.points.size(), 4u);
}

TEST(ReadMesh, offMayHaveCommentsColoursNormalsAndCountsInTheHeaderLine) {
  const auto plain =
      readText("a.off", "OFF 3 1 3 # counts\n# points\n0 0 0\n\n1 0 0\n0 1 0\n3 0 1 2  255 0 0\n");
  const auto rich = readText(
      "b.off", "CNOFF\n3 1\n0 0 0 0 0 1 1 1 1 1\n1 0 0 0 0 1 1 1 1 1\n0 1 0 0 0 1 1 1 1 1\n3 0 1 2\n");
  EXPECT_EQ(plain.soup.triangles, rich.soup.triangles);
  EXPECT_EQ(plain.soup.points, rich.soup.points);
}

TEST(ReadMesh, plyMayHaveAnyOrderTypesAndFurtherElements) {
  const std::string head =
      "element camera 1\nproperty list uchar float settings\nproperty int8 kind\n"
      "element vertex 3\nproperty uchar red\nproperty float z\nproperty float32 y\nproperty double x\n"
      "element face 1\nproperty short flags\nproperty list uint16 uint8 vertex_index\nproperty float "
      "quality\nend_header\n";
  const auto text = readText("a.ply", "ply\nformat ascii 1.0\nobj_info none\n" + head +
                                          "2 0.5 1.5 7\n255 3 2 1\n0 0 0 1\n0 0 1 0\n-4 3 0 1 2 0.25\n");
  std::string body;
  const auto append = [&](auto bits) { body += bytesOf(bits, sizeof bits, true); };
  const auto single = [&](float x) { append(std::bit_cast<std::uint32_t>(x)); };
  body += std::string("\x02", 1), single(0.5f), single(1.5f), body += '\7';
  for (const std::array<float, 3>& zyx : {std::array{3.f, 2.f, 1.f}, {0.f, 0.f, 1.f}, {0.f, 1.f, 0.f}}) {
    body += '\0', single(zyx[0]), single(zyx[1]), append(std::bit_cast<std::uint64_t>(double(zyx[2])));
  }
  append(std::uint16_t(-4)), append(std::uint16_t(3)), body += std::string("\0\1\2", 3), single(0.25f);
  const auto binary = readText("b.ply", "ply\nformat binary_big_endian 1.0\n" + head + body);
  EXPECT_EQ(text.soup.points, (std::vector<Eigen::Vector3d>{{1, 2, 3}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(binary.soup.points, text.soup.points);
  EXPECT_EQ(binary.soup.triangles, text.soup.triangles);
}

TEST(ReadMesh, stlCornersAtTheSamePlaceAreOneVertex) {
  EXPECT_EQ(readText("a.stl", stlBinary(cube())).soup.points.size(), 8u);
  const auto zeros = readText(
      "b.stl",
      "SOLID two zeros\nFACET NORMAL nan 0 0 OUTER LOOP VERTEX 0 0 0 VERTEX 1 0 0 VERTEX 0 1 0 ENDLOOP "
      "ENDFACET facet normal 0 0 1 outer loop vertex -0 0 0 vertex 0 1 0 vertex -1 0 0 endloop endfacet\n"
      "endsolid\n");
  EXPECT_EQ(zeros.soup.points.size(), 4u);
}

/// Writes and reads 1,5 for one and a half.
struct DecimalComma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
};

TEST(ReadMesh, numbersAreReadAlikeInEveryLocale) {
  const std::locale before = std::locale::global(std::locale(std::locale(), new DecimalComma));
  const auto file = readText("a.obj", "v 0.25 0 0\nv 1.5e0 0 0\nv 0 1 0\nf 1 2 3\n");
  std::locale::global(before);
  EXPECT_EQ(file.soup.points[0].x(), 0.25);
  EXPECT_EQ(file.soup.points[1].x(), 1.5);
}

TEST(ReadMesh, damagedObjNamesItsLine) {
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_TRUE(holds(complaint("a.obj", points + "f 1 2 4\n"), "line 4"));
  EXPECT_TRUE(holds(complaint("a.obj", points + "f 1 2 0\n"), "line 4"));
  EXPECT_TRUE(holds(complaint("a.obj", points + "f 1 2 -4\n"), "line 4"));
  EXPECT_TRUE(holds(complaint("a.obj", points + "f 1 2\n"), "fewer than three"));
  EXPECT_TRUE(holds(complaint("a.obj", points + "f 1 2 2\n"), "twice"));
  EXPECT_TRUE(holds(complaint("a.obj", points + "f 1 2 3x\n"), "3x"));
  EXPECT_TRUE(holds(complaint("a.obj", points + "f 1/ 2 3\n"), "slash"));
  EXPECT_TRUE(holds(complaint("a.obj", points + "f 99999999999999999999 2 3\n"), "whole number"));
  EXPECT_TRUE(holds(complaint("a.obj", points + "v 1 1\n"), "line 4"));
  EXPECT_TRUE(holds(complaint("a.obj", points + "v 1 1,5 0\n"), "1,5"));
  EXPECT_TRUE(holds(complaint("a.obj", points + "v 1 nan 0\n"), "finite"));
  EXPECT_TRUE(holds(complaint("a.obj", points + "v 1 1e999 0\n"), "finite"));
  EXPECT_TRUE(holds(complaint("a.obj", points + "v 1 1e300 0\n"), "large"));
  EXPECT_TRUE(holds(complaint("a.obj", points + "face 1 2 3\n"), "face"));
  EXPECT_TRUE(holds(complaint("a.obj", points), "no faces"));
}

TEST(ReadMesh, announcedCountsAreNotBelieved) {
  EXPECT_TRUE(holds(complaint("a.off", "OFF\n3000000000 1 0\n0 0 0\n"), "line 3"));
  EXPECT_TRUE(holds(complaint("a.off", "OFF\n-3 1 0\n0 0 0\n"), "negative"));
  EXPECT_TRUE(holds(complaint("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2000000000 0 1 2\n"), "missing"));
  EXPECT_TRUE(holds(complaint("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 2\n"), "goes on"));
  const std::string head =
      "ply\nformat binary_little_endian 1.0\nelement nothing 9000000000000000000\nelement vertex "
      "4000000000\nproperty float x\n"
      "property float y\nproperty float z\nelement face 1\nproperty list uint int "
      "vertex_indices\nend_header\n";
  EXPECT_TRUE(holds(complaint("a.ply", head), "cut short"));
  EXPECT_TRUE(holds(complaint("b.ply",
                              "ply\nformat binary_little_endian 1.0\nelement vertex 0\nproperty float x\n"
                              "property float y\nproperty float z\nelement face 1\n"
                              "property list uint int vertex_indices\nend_header\n\xff\xff\xff\xff"),
                    "cut short"));
  std::string stl = stlBinary(cube());
  stl[83] = '\x7f';
  EXPECT_TRUE(holds(complaint("a.stl", stl), "cut short or damaged"));
}

TEST(ReadMesh, unusableFilesAreRefused) {
  EXPECT_TRUE(holds(complaint("empty.obj", ""), "empty"));
  EXPECT_TRUE(holds(complaint("mesh.txt", "v 0 0 0\n"), ".obj"));
  EXPECT_TRUE(holds(complaint("mesh", "v 0 0 0\n"), ".obj"));
  const auto folder = fileWith("x.obj", "v").parent_path();
  EXPECT_TRUE(holds(errorOf([&] { readMesh(folder / "missing.obj"); })->what(), "no file"));
  std::filesystem::create_directories(folder / "folder.obj");
  EXPECT_TRUE(holds(errorOf([&] { readMesh(folder / "folder.obj"); })->what(), "folder"));
}

TEST(ReadMesh, polygonsKeepAreaAndOrientation) {
  // An L, a convex quad, a quad with a reflex corner, and one with a corner in the middle of a side.
  const std::vector<std::vector<Eigen::Vector3d>> polygons = {
      {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}},
      {{0, 0, 0}, {3, 0, 0}, {3, 1, 0}, {0, 1, 0}},
      {{0, 0, 0}, {1, 0.2, 0}, {3, 0, 0}, {1, 3, 0}},
      {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 2, 0}}};
  const std::vector<double> areas = {3, 3, 4.2, 2};
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    const auto triangles = triangulatePolygon(polygons[i]);
    ASSERT_TRUE(triangles);
    EXPECT_EQ(triangles->size(), polygons[i].size() - 2);
    double area = 0;
    for (const auto& [a, b, c] : *triangles) {
      const double twice = (polygons[i][b] - polygons[i][a]).cross(polygons[i][c] - polygons[i][a]).z();
      EXPECT_GT(twice, 0);
      area += twice / 2;
    }
    EXPECT_NEAR(area, areas[i], 1e-14);
  }
}

TEST(ReadMesh, aQuadThatIsNotFlatIsDividedFromItsFirstCornerWhereThatLiesInside) {
  using Triangles = std::vector<std::array<int, 3>>;
  const std::vector<Eigen::Vector3d> saddle{{0, 0, 1}, {3, 1, 0}, {4, 4, 1}, {1, 3, 0}},
      dart{{0, 0, 0}, {2, -1, 0}, {0.5, 0, 0.3}, {2, 1, 0}}, turned{dart[1], dart[2], dart[3], dart[0]};
  EXPECT_EQ(triangulatePolygon(saddle), (Triangles{{0, 1, 2}, {0, 2, 3}})) << "the longer diagonal";
  EXPECT_EQ(triangulatePolygon(dart), (Triangles{{0, 1, 2}, {0, 2, 3}}));
  const auto other = triangulatePolygon(turned);
  ASSERT_TRUE(other);
  for (const auto& triangle : *other)
    EXPECT_TRUE(std::count(triangle.begin(), triangle.end(), 1) &&
                std::count(triangle.begin(), triangle.end(), 3))
        << "from the reflex corner";
}

TEST(ReadMesh, aCrossingPolygonIsRefused) {
  EXPECT_TRUE(holds(complaint("a.obj", "v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 1 0\nf 1 2 3 4\n"), "crosses itself"));
}

TEST(ReadMesh, randomStarPolygonsTriangulateWithoutOverlap) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> radius(0.1, 1);
  for (int round = 0; round < 200; ++round) {
    std::vector<Eigen::Vector3d> polygon;
    const int n = 4 + round % 20;
    double expected = 0;
    for (int i = 0; i < n; ++i) {
      const double r = radius(random), a = 2 * kPi * i / n;
      polygon.emplace_back(r * std::cos(a), r * std::sin(a), 0.3 * r * std::cos(a));
    }
    for (int i = 0; i < n; ++i)
      expected +=
          polygon[i].head<2>().x() * polygon[(i + 1) % n].y() - polygon[i].y() * polygon[(i + 1) % n].x();
    const auto triangles = triangulatePolygon(polygon);
    ASSERT_TRUE(triangles) << "round " << round;
    double area = 0;
    for (const auto& [a, b, c] : *triangles)
      area += std::abs((polygon[b] - polygon[a]).cross(polygon[c] - polygon[a]).z());
    EXPECT_NEAR(area, expected, 1e-12) << "round " << round;
  }
}

}  // namespace
}  // namespace trimquad
