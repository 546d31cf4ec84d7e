#include "trimquad/mesh/read_map.h"

#include <gtest/gtest.h>

#include "support/sample_maps.h"
#include "trimquad/base/error.h"
#include "trimquad/mesh/write_obj.h"

using namespace trimquad;
using namespace trimquad::samples;

TEST(ReadMap, givesBackWhatWasWritten) {
  std::mt19937 random(5);
  GridMap map = gridMapOf(cone(5, 4, 1.3), 30);
  shuffleCharts(map, random);
  for (const auto e : map.mesh.edges())
    if (map.mesh.is_boundary(e)) map.aligned.push_back(e);
  map.featurePoints = {VertexHandle(3), VertexHandle(7)};
  const Parametrization read = readMapObj("map.obj", writeObj(map));
  // Which corner of a triangle comes first, and so how edges are numbered, is not in the file.
  ASSERT_EQ(read.mesh.n_faces(), map.mesh.n_faces());
  for (const auto h : map.mesh.halfedges()) {
    const auto same = read.mesh.find_halfedge(map.mesh.from_vertex_handle(h), map.mesh.to_vertex_handle(h));
    ASSERT_TRUE(same.is_valid());
    if (!map.mesh.is_boundary(h)) {
      EXPECT_EQ(read.mesh.face_handle(same), map.mesh.face_handle(h));
      EXPECT_EQ(read.scale.toQuads(read.from(same)), map.scale.toQuads(map.from(h)));
    }
  }
  EXPECT_NO_THROW(verify(read, false));
  EXPECT_EQ(coneQuarters(read), coneQuarters(map));
  EXPECT_EQ(read.featurePoints, map.featurePoints);
  EXPECT_EQ(read.aligned.size(), map.aligned.size());
  for (const auto e : read.aligned) EXPECT_TRUE(read.mesh.is_boundary(e));
}

TEST(ReadMap, saysWhereAFileIsDamaged) {
  const auto message = [](const std::string& text) -> std::string {
    try {
      readMapObj("map.obj", text);
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  };
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n";
  EXPECT_EQ(message(points + "f 1/1 2/2 3/3\n"), "");
  EXPECT_NE(message(points + "f 1/1 2/2 3/4\n").find("line 7"), std::string::npos);
  EXPECT_NE(message(points + "f 1 2 3\n").find("vertex/texture"), std::string::npos);
  EXPECT_NE(message(points + "f 1/1 2/2 3/3\nl 1 1\n").find("no edge"), std::string::npos);
  EXPECT_NE(message(points + "vt 0.1 1e-300\nf 1/1 2/2 3/3\n").find("vt 4"), std::string::npos);
}
