#include "trimquad/brep/face_separation.h"

// Before OpenCASCADE, whose macro Handle() breaks OpenMesh.
#include "support/trim_samples.h"

#include <gtest/gtest.h>

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

const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();

TEST(FaceSeparation, flatFacesOfABoxAreApartButForTheirEdges) {
  const auto model = test::bulgedBox(0).trim();
  const FaceSeparation separation(model);
  for (int a = 0; a < 6; ++a)
    for (int b = 0; b < a; ++b) EXPECT_TRUE(separation.areApart(a, b)) << a << " " << b;
}

TEST(FaceSeparation, curvedFacesThatShareSomethingAreNotToldApart) {
  const auto model = test::bulgedBox(0.8).trim();
  const FaceSeparation separation(model);
  for (int a = 0; a < 6; ++a)
    for (int b = 0; b < a; ++b) EXPECT_FALSE(separation.areApart(a, b)) << a << " " << b;
}

TEST(FaceSeparation, aCurvedFaceIsApartFromAPlaneBesideIt) {
  for (const double height : {3.2, 10.0}) {
    Rectangles r;
    r.model = test::bulgedBox(0.8, {5}).trim();  // the top, from 3.56 to 4.04
    r.add(Vector3d(-9, -9, height), 18 * x, 18 * y);
    EXPECT_TRUE(r.areApart(0, 1));
    EXPECT_TRUE(r.areApart(1, 0));
  }
  Rectangles r;
  r.model = test::bulgedBox(0.8, {5}).trim();
  r.add(Vector3d(-9, -9, 3.8), 18 * x, 18 * y);
  EXPECT_FALSE(r.areApart(0, 1));
}

TEST(FaceSeparation, facesThatCrossTouchOrLieInOnePlaneAreNot) {
  Rectangles r;
  r.add(Vector3d::Zero(), x, y);
  r.add(Vector3d(0.5, -1, -1), 3 * y, 3 * z);   // crosses
  r.add(Vector3d(0.5, 0.2, 0), 0.5 * y, z);     // stands on it
  r.add(Vector3d(0.5, 0.2, 1e-7), 0.5 * y, z);  // as good as
  r.add(Vector3d(0.5, 0.5, 0), x, y);           // overlaps
  r.add({0, 1, 2, 3});                          // is the same
  for (int b = 1; b < 6; ++b) {
    EXPECT_FALSE(r.areApart(0, b)) << b;
    EXPECT_FALSE(r.areApart(b, 0)) << b;
  }
  r.add(Vector3d(0.5, 0.2, 1e-3), 0.5 * y, z);
  EXPECT_TRUE(r.areApart(0, 6));
}

TEST(FaceSeparation, aSharedCornerMayTouchButNoOther) {
  Rectangles r;
  r.add(Vector3d::Zero(), x, y);
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
