#include "trimquad/mesh/write_obj.h"

#include <sstream>

#include "mesh_file_samples.h"
#include "support/mesh_samples.h"

namespace trimquad {
namespace {

/// The identity on a flat sheet, scaled by a third so that coordinates have no short decimals.
Parametrization flatMap(int columns, int rows) {
  Parametrization map;
  map.mesh = buildSurfaceMesh(flatSheet(columns, rows));
  map.scale.bits = 30;
  map.corner.resize(map.mesh.n_halfedges());
  for (const auto h : map.mesh.halfedges()) {
    const auto p = map.mesh.point(map.mesh.from_vertex_handle(h));
    map.corner[h.idx()] = map.scale.round(Eigen::Vector2d(p.x() / 3, p.y() / 3));
  }
  return map;
}

std::vector<std::string> linesWith(const std::string& text, const std::string& statement) {
  std::vector<std::string> found;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);)
    if (line.starts_with(statement + " ")) found.push_back(line);
  return found;
}

TEST(WriteObj, textCoordinatesAreTheExactOnes) {
  const auto map = flatMap(3, 2);
  const std::string text = writeObj(map);
  const auto images = linesWith(text, "vt"), faces = linesWith(text, "f");
  ASSERT_EQ(faces.size(), map.mesh.n_faces());
  for (const auto f : map.mesh.faces()) {
    std::istringstream corners(faces[f.idx()].substr(2));
    for (const auto h : map.mesh.fh_range(f)) {
      int v = 0, image = 0;
      char slash = 0;
      corners >> v >> slash >> image;
      EXPECT_EQ(v - 1, map.mesh.from_vertex_handle(h).idx());
      double x = 0, y = 0;
      std::istringstream(images[image - 1].substr(3)) >> x >> y;
      EXPECT_EQ(Eigen::Vector2d(x, y), map.scale.toQuads(map.from(h)));
    }
  }
}

TEST(WriteObj, aVertexHasOneImageAwayFromCutsAndTwoOnThem) {
  auto map = flatMap(4, 3);
  EXPECT_EQ(linesWith(writeObj(map), "vt").size(), 20u);
  // Shift the chart of the two right columns: the four vertices between get a second image.
  for (const auto f : map.mesh.faces())
    if (map.mesh.calc_face_centroid(f).x() > 2)
      for (const auto h : map.mesh.fh_range(f)) map.corner[h.idx()].u += map.scale.one();
  EXPECT_EQ(linesWith(writeObj(map), "vt").size(), 24u);
}

TEST(WriteObj, groupsListAlignedEdgesAndFeaturePoints) {
  auto map = flatMap(2, 2);
  EXPECT_EQ(writeObj(map).find("\ng "), std::string::npos);
  const auto h = map.mesh.find_halfedge(VertexHandle(0), VertexHandle(3));
  map.aligned = {map.mesh.edge_handle(h)};
  map.featurePoints = {VertexHandle(4)};
  const std::string text = writeObj(map);
  EXPECT_TRUE(text.find("g aligned\nl 1 4\n") != std::string::npos ||
              text.find("g aligned\nl 4 1\n") != std::string::npos);
  EXPECT_NE(text.find("g feature\np 5\n"), std::string::npos);
}

TEST(WriteObj, itsOwnReaderTakesIt) {
  const auto map = flatMap(5, 4);
  const auto file = readText("map.obj", writeObj(map));
  EXPECT_EQ(file.soup.triangles.size(), map.mesh.n_faces());
  for (const auto v : map.mesh.vertices()) EXPECT_EQ(file.soup.points[v.idx()], map.mesh.point(v));
}

}  // namespace
}  // namespace trimquad
