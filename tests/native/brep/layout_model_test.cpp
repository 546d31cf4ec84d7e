#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <numbers>

// Before OpenCASCADE, whose macro Handle() breaks OpenMesh.
#include "support/analytic_region.h"
#include "support/grid_maps.h"
#include "support/sample_maps.h"
#include "trimquad/spline/trim_model.h"

#include <BRepGProp.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>

#include "trimquad/brep/assemble.h"
#include "trimquad/brep/shape.h"

namespace trimquad {
namespace {

struct Built {
  Model model;
  std::vector<FittedSurface> fitted;
  SplineModel spline;
};

/// Fits and trims a model; `maps[i]` belongs to region i.
Built build(Model model, const std::vector<GridMap>& maps, double tolerance) {
  Built built{std::move(model), {}, {}};
  std::vector<const GridMap*> mapPointers;
  std::vector<const FittedSurface*> fitPointers;
  for (std::size_t r = 0; r < maps.size(); ++r) {
    built.fitted.push_back(
        fitSurface(built.model.regions[r], maps[r], {.tolerance = tolerance, .degree = 3}, Progress()));
    EXPECT_LE(built.fitted[r].maxDeviation, tolerance);
    mapPointers.push_back(&maps[r]);
  }
  for (const auto& fit : built.fitted) fitPointers.push_back(&fit);
  built.spline = trimModel(built.model, mapPointers, fitPointers, {tolerance}, Progress());
  return built;
}

double largestEdgeTolerance(const Shape& shape) {
  double tolerance = 0;
  TopTools_IndexedMapOfShape edges;
  TopExp::MapShapes(shape.topology(), TopAbs_EDGE, edges);
  for (int i = 1; i <= edges.Extent(); ++i)
    tolerance = std::max(tolerance, BRep_Tool::Tolerance(TopoDS::Edge(edges(i))));
  return tolerance;
}

double volumeOf(const Shape& shape) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape.topology(), properties, 1e-6);
  return properties.Mass();
}

/// Without faults and with tolerances of 1e-7 before and after a journey through STEP.
Shape expectSound(const SplineModel& model) {
  const Shape shape = assemble(model);
  EXPECT_EQ(faults(shape), std::vector<std::string>{});
  EXPECT_LE(largestEdgeTolerance(shape), 1.001e-7);
  const auto path =
      (std::filesystem::temp_directory_path() / ("trimquad_layout_" + std::to_string(::getpid()) + ".step"))
          .string();
  writeStep(shape, path);
  const Shape back = readShape(path);
  std::filesystem::remove(path);
  EXPECT_EQ(faults(back), std::vector<std::string>{});
  return back;
}

/// Degrees between the normals of both sides of all borders inside regions.
double largestCrease(const FittedSurface& fitted) {
  double largest = 0;
  for (const auto& border : fitted.layout->borders)
    for (int i = 0; i <= 100; ++i) {
      Eigen::Vector3d normal[2];
      for (int side : {0, 1}) {
        const Eigen::Vector2d x = border.start[side] + (border.end[side] - border.start[side]) * i / 100;
        const auto jet = fitted.surfaces[border.chart[side]].jet(x[0], x[1]);
        normal[side] = jet.su.cross(jet.sv);
      }
      largest = std::max(largest, std::atan2(normal[0].cross(normal[1]).norm(), normal[0].dot(normal[1])));
    }
  return largest * 180 / std::numbers::pi;
}

Model modelOf(const SurfaceMesh& mesh, FeatureOptions::Sharp sharp = FeatureOptions::Sharp::Ignore) {
  MeshModelOptions options;
  options.features.sharp = sharp;
  return meshModel(sample::soupOf(mesh), options, Progress());
}

TEST(LayoutModel, aSphereOfSixSquaresIsASmoothSolid) {
  GridMap map = sample::boxesMap({{0, 0, 0}}, 16, 4);
  sample::bend(map, [](const Eigen::Vector3d& p) -> Eigen::Vector3d {
    const Eigen::Vector3d x = (2 * p - Eigen::Vector3d::Ones()) * (std::numbers::pi / 4);
    return 10 * x.array().tan().matrix().normalized();
  });
  Model model = modelOf(map.mesh);
  model.regions[0].surface = std::make_shared<SphereSurface>(10);
  const auto built = build(model, {sample::mapOn(model.regions[0], map)}, 0.01);
  EXPECT_EQ(built.spline.faces.size(), 6u);
  EXPECT_EQ(built.spline.vertices.size(), 8u);
  EXPECT_LE(largestCrease(built.fitted[0]), 0.2);
  EXPECT_TRUE(built.spline.shells.at(0).solid.has_value());
  EXPECT_NEAR(volumeOf(expectSound(built.spline)), 4000 * std::numbers::pi / 3, 2);
}

TEST(LayoutModel, aTorusIsASmoothSolid) {
  auto map = samples::gridMapOf(samples::wrapped(36, 12, 0.5, 0.5, true));
  const Model model = modelOf(map.mesh);
  const auto built = build(model, {sample::mapOn(model.regions[0], map)}, 0.05);
  EXPECT_EQ(built.spline.faces.size(), 4u);
  EXPECT_LE(largestCrease(built.fitted[0]), 1e-3);
  EXPECT_NEAR(volumeOf(expectSound(built.spline)), 2 * 3 * std::numbers::pi * std::numbers::pi, 3);
}

/// A ring of eight boxes with its corners rounded off by smoothing.
GridMap roundedRing(int n, int quads) {
  std::vector<std::array<int, 3>> ring;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (i != 1 || j != 1) ring.push_back({i, j, 0});
  GridMap map = sample::boxesMap(ring, n, quads);
  for (int step = 0; step < 4 * n; ++step) {
    auto smoothed = map.mesh;
    for (const auto v : map.mesh.vertices()) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (const auto w : map.mesh.vv_range(v)) sum += map.mesh.point(w) / map.mesh.valence(v);
      smoothed.set_point(v, (map.mesh.point(v) + sum) / 2);
    }
    map.mesh = smoothed;
  }
  return map;
}

TEST(LayoutModel, aRoundedRingOfBoxesIsASolid) {
  const GridMap map = roundedRing(8, 2);
  const Model model = modelOf(map.mesh);
  const auto built = build(model, {sample::mapOn(model.regions[0], map)}, 0.015);
  EXPECT_LE(built.spline.faces.size(), 24u);
  EXPECT_LE(largestCrease(built.fitted[0]), 10);
  EXPECT_TRUE(built.spline.shells.at(0).solid.has_value());
  EXPECT_GT(volumeOf(expectSound(built.spline)), 5);
}

Eigen::Vector3d vaulted(const Eigen::Vector3d& p) {
  return {p[0], p[1], -0.05 * p.head<2>().squaredNorm()};
}

TEST(LayoutModel, aConeEndsOnItsFreeBoundary) {
  for (const int quarters : {3, 5, 6}) {
    GridMap map = samples::gridMapOf(samples::cone(quarters, 14, 4.37));
    sample::bend(map, vaulted);
    const Model model = modelOf(map.mesh);
    const auto built = build(model, {sample::mapOn(model.regions[0], map)}, 0.01);
    EXPECT_EQ(built.spline.faces.size(), std::size_t(quarters));
    EXPECT_LE(largestCrease(built.fitted[0]), 1);
    expectSound(built.spline);
    // Borders end on the boundary, within what the fit allows.
    int free = 0;
    std::vector<int> uses(built.spline.edges.size(), 0);
    for (const auto& face : built.spline.faces)
      for (const auto& coedge : face.loops.at(0)) ++uses[coedge.edge.index];
    for (const int n : uses) free += n == 1;
    EXPECT_GE(free, quarters);
  }
}

TEST(LayoutModel, sectorsOfUnequalWidthMeetSmoothly) {
  for (const int quarters : {3, 5}) {
    GridMap map = samples::gridMapOf(samples::cone(quarters, 24, 4.37));
    sample::bend(map, [](const Eigen::Vector3d& p) -> Eigen::Vector3d {
      const double angle = std::atan2(p[1], p[0]), r = p.head<2>().norm(),
                   to = angle + 0.45 * std::sin(angle);
      const Eigen::Vector3d q(r * std::cos(to), r * std::sin(to), 0);
      return {q[0], q[1], -0.6 * std::sqrt(1 + q.head<2>().squaredNorm())};
    });
    const Model model = modelOf(map.mesh);
    const auto built = build(model, {sample::mapOn(model.regions[0], map)}, 0.006);
    std::size_t poles = 0;
    for (const auto& face : built.spline.faces) poles += face.surface.poles.size();
    EXPECT_LE(poles, 800u) << quarters;
    EXPECT_LE(largestCrease(built.fitted[0]), 1) << quarters;
  }
}

/// The point of samples::cone on a paraboloid over a disk: squares become sectors, smoothly.
Eigen::Vector3d roundVault(const Eigen::Vector3d& p, int quarters, double width) {
  double turn = std::atan2(p[1], p[0]) / (2 * std::numbers::pi) * quarters;
  turn -= quarters * std::floor(turn / quarters);
  const double angle = (turn - std::floor(turn)) * std::numbers::pi / 2, r = p.head<2>().norm() / width;
  const double u = r * std::cos(angle), v = r * std::sin(angle);
  const double x = u * std::sqrt(1 - v * v / 2), y = v * std::sqrt(1 - u * u / 2);
  const double round = std::hypot(x, y), to = (std::floor(turn) + std::atan2(y, x) / (std::numbers::pi / 2)) *
                                              2 * std::numbers::pi / quarters;
  return {width * round * std::cos(to), width * round * std::sin(to), 2 * (1 - std::min(1.0, round * round))};
}

TEST(LayoutModel, aVaultOnAFlatFloorSharesItsEdges) {
  for (const int quarters : {3, 5}) {
    auto mapped = samples::cone(quarters, 12, 4.37);
    const int vaultTriangles = int(mapped.soup.triangles.size());
    for (auto& p : mapped.soup.points) p = roundVault(p, quarters, 4.37);
    // The floor: the boundary's points joined to a point in the middle.
    const auto vault = samples::gridMapOf(mapped);
    const auto loop = boundaryLoops(vault.mesh).at(0);
    TriangleSoup soup = mapped.soup;
    const int centre = int(soup.points.size());
    soup.points.push_back({0, 0, 0});
    for (const auto h : loop) {
      const int a = vault.mesh.from_vertex_handle(h).idx(), b = vault.mesh.to_vertex_handle(h).idx();
      soup.triangles.push_back({a, b, centre});
    }
    MeshModelOptions options;
    options.features.sharp = FeatureOptions::Sharp::Trim;
    Model model = meshModel(soup, options, Progress());
    ASSERT_EQ(model.regions.size(), 2u);
    std::vector<GridMap> maps;
    for (const auto& region : model.regions) {
      if (region.inputTriangle.front() < vaultTriangles) {
        maps.push_back(sample::mapOn(region, vault));
        continue;
      }
      // The floor, seen from below.
      GridMap& map = maps.emplace_back();
      map.mesh = region.mesh;
      map.scale = FixedScale{24};
      map.corner.resize(map.mesh.n_halfedges());
      for (const auto h : map.mesh.halfedges()) {
        const Eigen::Vector3d p = map.mesh.point(map.mesh.from_vertex_handle(h));
        if (!map.mesh.is_boundary(h)) map.corner[h.idx()] = map.scale.round(Eigen::Vector2d(-p[0], p[1]));
      }
    }
    const auto built = build(model, maps, 0.02);
    EXPECT_EQ(built.spline.faces.size(), std::size_t(quarters + 1));
    EXPECT_TRUE(built.spline.shells.at(0).solid.has_value());
    expectSound(built.spline);
  }
}

}  // namespace
}  // namespace trimquad
