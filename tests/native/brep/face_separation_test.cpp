#include "trimquad/brep/face_separation.h"

// Before OpenCASCADE, whose macro Handle() breaks OpenMesh.
#include "support/trim_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

namespace trimquad {
namespace {

using Eigen::Vector3d;

/// Rectangles on shared corners.
struct Rectangles {
  SplineModel model;

  int corner(const Vector3d& p) {
    model.vertices.push_back({p, 1e-7});
    return int(model.vertices.size()) - 1;
  }
  /// The edges between the same corners are the same.
  void add(const std::array<int, 4>& corners) {
    SplineFace face{.surface = {.degreeU = 1,
                                .degreeV = 1,
                                .knotsU = {0, 0, 1, 1},
                                .knotsV = {0, 0, 1, 1},
                                .countU = 2,
                                .countV = 2,
                                .poles = {at(corners[0]), at(corners[1]), at(corners[3]), at(corners[2])}},
                    .loops = {{}},
                    .region = 0};
    for (int k = 0; k < 4; ++k) {
      const int a = corners[k], b = corners[(k + 1) % 4];
      face.loops[0].push_back({edge(std::min(a, b), std::max(a, b)), a < b, {}});
    }
    model.faces.push_back(face);
  }
  void add(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
    add({corner(p), corner(p + a), corner(p + a + b), corner(p + b)});
  }
  bool areApart(int a, int b) const { return FaceSeparation(model).areApart(a, b); }

 private:
  const Vector3d& at(int corner) const { return model.vertices[corner].point; }
  SplineEdgeId edge(int a, int b) {
    for (std::size_t e = 0; e < model.edges.size(); ++e)
      if (model.edges[e].start.index == a && model.edges[e].end.index == b) return {int(e)};
    model.edges.push_back({{1, {0, 0, 1, 1}, {at(a), at(b)}}, {a}, {b}, 1e-7});
    return {int(model.edges.size()) - 1};
  }
};

const Vector3d alongX = Vector3d::UnitX(), alongY = Vector3d::UnitY(), alongZ = Vector3d::UnitZ();

TEST(FaceSeparation, flatFacesOfABoxAreApartButForTheirEdges) {
  const auto model = test::bulgedBox(0).trim();
  const FaceSeparation separation(model);
  for (int a = 0; a < 6; ++a)
    for (int b = 0; b < a; ++b) EXPECT_TRUE(separation.areApart(a, b)) << a << " " << b;
}

TEST(FaceSeparation, curvedFacesThatShareSomethingAreNotToldApartButOthersAre) {
  const auto model = test::bulgedBox(0.8).trim();
  const FaceSeparation separation(model);
  for (int a = 0; a < 6; ++a)
    for (int b = 0; b < a; ++b) EXPECT_EQ(separation.areApart(a, b), a / 2 == b / 2) << a << " " << b;
}

/// The top of a bulged box, from 3.56 to 4.04, within 5 and 4 of the origin and the bulges of its sides; its
/// surface reaches further.
Rectangles withCurvedTop() {
  Rectangles r;
  r.model = test::bulgedBox(0.8, {5}).trim();
  return r;
}

TEST(FaceSeparation, aCurvedFaceIsApartFromAPlaneThatItsTrimDoesNotReach) {
  Rectangles r = withCurvedTop();
  r.add(Vector3d(-9, -9, 3.2), 18 * alongX, 18 * alongY);  // 1: below
  r.add(Vector3d(-9, -9, 10), 18 * alongX, 18 * alongY);   // 2: above
  r.add(Vector3d(6.5, -9, -9), 18 * alongY, 18 * alongZ);  // 3: through the surface beside the trim
  r.add(Vector3d(-9, -9, 3.8), 18 * alongX, 18 * alongY);  // 4: through the face
  r.add(Vector3d(-9, 0, 3.8), 5 * alongX, alongY);         // 5: reaches into it
  r.add(Vector3d(-9, 0, 3.8), 2 * alongX, alongY);         // 6: ends before it
  for (const auto& [face, apart] :
       std::map<int, bool>{{1, true}, {2, true}, {3, true}, {4, false}, {5, false}, {6, true}}) {
    EXPECT_EQ(r.areApart(0, face), apart) << face;
    EXPECT_EQ(r.areApart(face, 0), apart) << face;
  }
}

TEST(FaceSeparation, curvedFacesAreApartWhereTheirCellsAre) {
  for (const double shift : {0.0, 0.05, 0.5, 13.0}) {
    auto model = test::bulgedBox(0.8, {5}).trim();
    auto above = model;
    const Vector3d way = shift > 10 ? Vector3d(shift, 0, 0.1) : Vector3d(0, 0, shift);
    for (auto& pole : above.faces[0].surface.poles) pole += way;
    for (auto& edge : above.edges) {
      for (auto& pole : edge.curve.poles) pole += way;
      edge.start.index += int(model.vertices.size());
      edge.end.index += int(model.vertices.size());
    }
    for (auto& vertex : above.vertices) vertex.point += way;
    for (auto& coedge : above.faces[0].loops[0]) coedge.edge.index += int(model.edges.size());
    model.vertices.insert(model.vertices.end(), above.vertices.begin(), above.vertices.end());
    model.edges.insert(model.edges.end(), above.edges.begin(), above.edges.end());
    model.faces.push_back(above.faces[0]);
    EXPECT_EQ(FaceSeparation(model).areApart(0, 1), shift > 0.1) << shift;
  }
}

TEST(FaceCells, holesAndWhatIsOutsideHaveNone) {
  // A surface of 10 alongX 10 unit rectangles; a trim from 1.5 to 8.5, a hole from 3.5 to 6.5.
  SplineFace face;
  auto& s = face.surface;
  s.degreeU = s.degreeV = 2;
  s.knotsU = {0, 0};
  for (int k = 0; k <= 10; ++k) s.knotsU.push_back(k);
  s.knotsU.insert(s.knotsU.end(), {10, 10});
  s.knotsV = s.knotsU;
  s.countU = s.countV = 12;
  const auto greville = [&](int i) { return (s.knotsU[i + 1] + s.knotsU[i + 2]) / 2; };
  for (int j = 0; j < 12; ++j)
    for (int i = 0; i < 12; ++i) s.poles.push_back({greville(i), greville(j), 0});
  const auto square = [](double low, double high, bool reversed) {
    std::vector<SplineCoedge> loop;
    const std::vector<Eigen::Vector2d> corners{{low, low}, {high, low}, {high, high}, {low, high}};
    for (int k = 0; k < 4; ++k)
      loop.push_back({{k}, !reversed, {1, {0, 0, 1, 1}, {corners[k], corners[(k + 1) % 4]}}});
    if (reversed) std::reverse(loop.begin(), loop.end());
    return loop;
  };
  face.loops = {square(1.5, 8.5, false), square(3.5, 6.5, true)};
  std::set<std::pair<int, int>> found;
  for (const auto& cell : faceCells(face)) {
    // Of a plane with equal knots, the points of a cell span it exactly.
    EXPECT_EQ(cell.points.size(), 9u);
    EXPECT_NEAR((cell.box.sizes() - Vector3d(1, 1, 0)).norm(), 0, 1e-12);
    found.insert({int(std::lround(cell.box.min()[0])), int(std::lround(cell.box.min()[1]))});
  }
  std::set<std::pair<int, int>> expected;
  for (int i = 1; i < 9; ++i)
    for (int j = 1; j < 9; ++j)
      if (i < 4 || i > 5 || j < 4 || j > 5) expected.insert({i, j});
  EXPECT_EQ(found, expected);
}

TEST(FaceSeparation, facesThatCrossTouchOrLieInOnePlaneAreNot) {
  Rectangles r;
  r.add(Vector3d::Zero(), alongX, alongY);
  r.add(Vector3d(0.5, -1, -1), 3 * alongY, 3 * alongZ);   // crosses
  r.add(Vector3d(0.5, 0.2, 0), 0.5 * alongY, alongZ);     // stands on it
  r.add(Vector3d(0.5, 0.2, 1e-7), 0.5 * alongY, alongZ);  // as good as
  r.add(Vector3d(0.5, 0.5, 0), alongX, alongY);           // overlaps
  r.add({0, 1, 2, 3});                                    // is the same
  for (int b = 1; b < 6; ++b) {
    EXPECT_FALSE(r.areApart(0, b)) << b;
    EXPECT_FALSE(r.areApart(b, 0)) << b;
  }
  r.add(Vector3d(0.5, 0.2, 1e-3), 0.5 * alongY, alongZ);
  EXPECT_TRUE(r.areApart(0, 6));
}

TEST(FaceSeparation, aSharedCornerMayTouchButNoOther) {
  Rectangles r;
  r.add(Vector3d::Zero(), alongX, alongY);
  const auto standing = [&](int foot) {
    return std::array<int, 4>{foot, r.corner({0.2, 0.2, 1}), r.corner({0.4, 0.4, 2}),
                              r.corner({0.2, 0.2, 1.5})};
  };
  r.add(standing(0));
  r.add(standing(r.corner(Vector3d::Zero())));
  EXPECT_TRUE(r.areApart(0, 1));
  EXPECT_FALSE(r.areApart(0, 2));
}

}  // namespace
}  // namespace trimquad
