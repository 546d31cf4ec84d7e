#include <gtest/gtest.h>

#include <numbers>

// Before OpenCASCADE, whose macro Handle() breaks OpenMesh.
#include "support/analytic_region.h"
#include "support/grid_maps.h"
#include "support/sample_maps.h"
#include "trimquad/brep/deviation_map.h"
#include "trimquad/mesh/mesh_model.h"
#include "trimquad/spline/trim_model.h"

#include <BRep_Tool.hxx>
#include <Geom_BSplineSurface.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>

#include "trimquad/brep/assemble.h"

namespace trimquad {
namespace {

/// A sphere of radius 10 about the origin from six squares.
struct Sphere {
  Model model;
  FittedSurface fitted;
  SplineModel spline;

  explicit Sphere(double tolerance) {
    GridMap map = sample::boxesMap({{0, 0, 0}}, 16, 4);
    sample::bend(map, [](const Eigen::Vector3d& p) -> Eigen::Vector3d {
      const Eigen::Vector3d x = (2 * p - Eigen::Vector3d::Ones()) * (std::numbers::pi / 4);
      return 10 * x.array().tan().matrix().normalized();
    });
    MeshModelOptions options;
    options.features.sharp = FeatureOptions::Sharp::Ignore;
    model = meshModel(sample::soupOf(map.mesh), options, Progress());
    model.regions[0].surface = std::make_shared<SphereSurface>(10);
    const GridMap own = sample::mapOn(model.regions[0], map);
    fitted = fitSurface(model.regions[0], own, {.tolerance = tolerance, .degree = 3}, Progress());
    spline = trimModel(model, {&own}, {&fitted}, {tolerance}, Progress());
  }
};

TEST(DeviationMap, pointsLieOnTheFacesAndDistancesAreThoseFromTheSphere) {
  const Sphere sphere(0.01);
  const auto maps = deviationMaps(sphere.spline, {&sphere.model.regions[0]}, {0.01, 1.0}, Progress());
  ASSERT_EQ(maps.size(), 6u);
  double largest = 0, area = 0;
  for (const auto& map : maps) {
    ASSERT_EQ(map.points.size(), map.distances.size());
    for (std::size_t i = 0; i < map.points.size(); ++i) {
      EXPECT_NEAR(map.distances[i], std::abs(map.points[i].norm() - 10), 1e-9);
      largest = std::max(largest, map.distances[i]);
    }
    for (const auto& [a, b, c] : map.triangles) {
      const Eigen::Vector3d p = map.points[a], q = map.points[b], r = map.points[c];
      for (const double side : {(p - q).norm(), (q - r).norm(), (r - p).norm()}) EXPECT_LE(side, 1.0);
      const Eigen::Vector3d normal = (q - p).cross(r - p);
      EXPECT_GT(normal.dot(p), 0);
      area += normal.norm() / 2;
    }
  }
  EXPECT_NEAR(area, 400 * std::numbers::pi, 2);
  // What the fit measured from the other side.
  EXPECT_LE(largest, 1.2 * sphere.fitted.maxDeviation);
  EXPECT_GE(largest, 0.6 * sphere.fitted.maxDeviation);
}

TEST(DeviationMap, distancesFromAMeshAreThoseFromItsTriangles) {
  Sphere sphere(0.01);
  sphere.model.regions[0].surface = nullptr;
  double largest = 0;
  for (const auto& map : deviationMaps(sphere.spline, {&sphere.model.regions[0]}, {0.01, 1.0}, Progress()))
    largest = std::max(largest, *std::max_element(map.distances.begin(), map.distances.end()));
  // The middle of a triangle, whose sides are about 10 / 10 long, lies 0.05 below the sphere.
  EXPECT_GT(largest, 0.01);
  EXPECT_LT(largest, 0.2);
}

TEST(DeviationMap, doesNotDependOnThreads) {
  const Sphere sphere(0.01);
  const std::vector<const Region*> regions{&sphere.model.regions[0]};
  const auto one = deviationMaps(sphere.spline, regions, {0.01, 0.5, 1}, Progress()),
             three = deviationMaps(sphere.spline, regions, {0.01, 0.5, 3}, Progress());
  for (std::size_t f = 0; f < one.size(); ++f) {
    EXPECT_EQ(one[f].points, three[f].points);
    EXPECT_EQ(one[f].distances, three[f].distances);
    EXPECT_EQ(one[f].triangles, three[f].triangles);
  }
}

TEST(FittedSurface, deviationsByChartMakeUpTheRegions) {
  const Sphere sphere(0.01);
  ASSERT_EQ(sphere.fitted.deviations.size(), 6u);
  double largest = 0;
  for (const auto& chart : sphere.fitted.deviations) {
    EXPECT_NEAR(chart.where.norm(), 10, 1e-9);
    EXPECT_LE(chart.rms, chart.max);
    EXPECT_GT(chart.rms, 0);
    largest = std::max(largest, chart.max);
  }
  EXPECT_EQ(largest, sphere.fitted.maxDeviation);
}

TEST(FaceOrder, isThatOfTheShapesFaces) {
  Sphere sphere(0.01);
  // A shell that bounds nothing comes before solids; its faces come first then.
  auto& shells = sphere.spline.shells;
  shells = {{{5, 1, 0}, 0}, {{4, 2, 3}, std::nullopt}};
  const auto order = faceOrder(sphere.spline);
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(assemble(sphere.spline).topology(), TopAbs_FACE, faces);
  ASSERT_EQ(faces.Extent(), 6);
  ASSERT_EQ(order.size(), 6u);
  for (int f = 0; f < 6; ++f) {
    const auto surface =
        Handle(Geom_BSplineSurface)::DownCast(BRep_Tool::Surface(TopoDS::Face(faces(f + 1))));
    const gp_Pnt pole = surface->Pole(2, 2);
    const auto& expected = sphere.spline.faces[order[f]].surface.pole(1, 1);
    EXPECT_EQ(Eigen::Vector3d(pole.X(), pole.Y(), pole.Z()), expected) << f;
  }
  EXPECT_EQ(order[0], 4);
}

}  // namespace
}  // namespace trimquad
