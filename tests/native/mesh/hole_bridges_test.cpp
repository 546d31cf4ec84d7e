#include "trimquad/mesh/hole_bridges.h"

#include <algorithm>

#include "support/mesh_samples.h"
#include "trimquad/mesh/hole_cap.h"
#include "trimquad/mesh/mesh_model.h"

namespace trimquad {
namespace {

/// A sheet of size x size squares without those that `leaveOut(x, y)`, by their centres.
TriangleSoup pierced(int size, const std::function<bool(double, double)>& leaveOut,
                     const std::function<Eigen::Vector3d(double, double)>& surface) {
  TriangleSoup soup = sheet(size, size, [](double x, double y) { return Eigen::Vector3d(x, y, 0); });
  std::erase_if(soup.triangles, [&](const auto& t) {
    const Eigen::Vector3d a = soup.points[t[0]], c = soup.points[t[2]], b = soup.points[t[1]];
    const Eigen::Vector3d low = a.cwiseMin(b).cwiseMin(c);
    return leaveOut(low.x() + 0.5, low.y() + 0.5);
  });
  std::vector<int> number(soup.points.size(), -1);
  TriangleSoup result;
  for (auto& t : soup.triangles)
    for (int& v : t) {
      if (number[v] < 0) {
        number[v] = int(result.points.size());
        result.points.push_back(surface(soup.points[v].x(), soup.points[v].y()));
      }
      v = number[v];
    }
  result.triangles = soup.triangles;
  return result;
}

Eigen::Vector3d flat(double x, double y) {
  return {x, y, 0};
}
Eigen::Vector3d wavy(double x, double y) {
  return {x, y, 2 * std::sin(0.3 * x) * std::cos(0.2 * y)};
}
bool twoHoles(double x, double y) {
  return std::hypot(x - 6, y - 6) < 2.2 || (x > 11 && x < 18 && y > 12 && y < 14) ||
         (x > 16 && x < 18 && y > 9 && y < 14);  // the second one is concave
}

Region regionOf(const TriangleSoup& soup, const MeshModelOptions& options = {}) {
  return meshModel(soup, options, Progress()).regions.front();
}

HoleCounts bridged(Region& region, double length) {
  return bridgeHoles(region, length, Progress());
}

double areaOf(const TriangleSoup& soup) {
  return surfaceArea(buildSurfaceMesh(soup));
}

}  // namespace

TEST(HoleCap, aConcavePolygonInThePlaneIsFilledExactly) {
  const std::vector<Eigen::Vector3d> loop{{0, 0, 0}, {4, 0, 0}, {4, 1, 0}, {1, 1, 0},
                                          {1, 3, 0}, {4, 3, 0}, {4, 4, 0}, {0, 4, 0}};
  const auto triangles = leastAreaTriangulation(loop, Progress());
  EXPECT_EQ(triangles.size(), loop.size() - 2);
  EXPECT_NEAR(areaOf({loop, triangles}), 10, 1e-12);
  for (const auto& [a, b, c] : triangles)
    EXPECT_GT((loop[b] - loop[a]).cross(loop[c] - loop[a]).z(), 0) << "turned over";
}

TEST(HoleCap, pointsOnALineMakeNoTriangle) {
  std::vector<Eigen::Vector3d> loop;
  for (int k = 0; k < 10; ++k) loop.emplace_back(k, 0, 0);
  for (int k = 0; k < 10; ++k) loop.emplace_back(10, k, 0);
  for (int k = 0; k < 10; ++k) loop.emplace_back(10 - k, 10, 0);
  for (int k = 0; k < 10; ++k) loop.emplace_back(0, 10 - k, 0);
  for (const auto& [a, b, c] : leastAreaTriangulation(loop, Progress()))
    EXPECT_GT((loop[b] - loop[a]).cross(loop[c] - loop[a]).z(), 0.5);
}

TEST(HoleCap, trianglesAreNearlyEquilateralAndNoEdgeInsideJoinsTwoPointsOfTheLoop) {
  std::vector<Eigen::Vector3d> loop;
  for (int k = 0; k < 60; ++k) {
    const double a = 2 * kPi * k / 60;
    loop.emplace_back(10 * std::cos(a), 10 * std::sin(a), std::sin(2 * a));
  }
  const TriangleSoup cap = holeCap(loop, 1, Progress());
  const SurfaceMesh mesh = buildSurfaceMesh(cap);
  EXPECT_EQ(eulerCharacteristic(mesh), 1);
  EXPECT_GT(cap.triangles.size(), 500u);
  EXPECT_LT(cap.triangles.size(), 1100u);
  int thin = 0;
  for (const auto h : mesh.halfedges())
    if (!mesh.is_boundary(h)) thin += cornerAngle(mesh, h) < 20 * kPi / 180;
  EXPECT_LT(thin, 5);
  for (const auto e : mesh.edges()) {
    const auto h = mesh.halfedge_handle(e, 0);
    EXPECT_TRUE(mesh.is_boundary(e) || !mesh.is_boundary(mesh.from_vertex_handle(h)) ||
                !mesh.is_boundary(mesh.to_vertex_handle(h)));
  }
  for (std::size_t k = 0; k < loop.size(); ++k) EXPECT_EQ(cap.points[k], loop[k]);
}

TEST(HoleBridges, onlyHolesShorterThanAskedForAreBridged) {
  const auto soup = pierced(24, twoHoles, flat);
  for (const auto& [length, expected] :
       {std::pair(5.0, 0), std::pair(17.0, 1), std::pair(30.0, 2), std::pair(1000.0, 2)}) {
    Region region = regionOf(soup);
    const HoleCounts counts = bridged(region, length);
    EXPECT_EQ(counts.bridged, expected) << length;
    EXPECT_EQ(counts.aligned, 0);
    EXPECT_EQ(counts.ends, length == 1000 ? 1 : 0) << "the outer boundary is no hole, however short";
    EXPECT_EQ(boundaryLoops(region.mesh).size(), std::size_t(3 - expected));
    EXPECT_EQ(eulerCharacteristic(region.mesh), -1 + expected);
    EXPECT_EQ(region.bridge.empty(), expected == 0);
    EXPECT_EQ(std::count(region.bridge.begin(), region.bridge.end(), true), counts.inBridges);
  }
  Region region = regionOf(soup);
  bridged(region, 1000);
  EXPECT_NEAR(surfaceArea(region.mesh), 24 * 24, 1e-9) << "caps of plane holes lie in them";
}

TEST(HoleBridges, cutOutAgainTheRegionIsAsItWas) {
  const Region before = regionOf(pierced(24, twoHoles, wavy));
  Region region = before;
  bridged(region, 1000);
  ASSERT_GT(region.mesh.n_faces(), before.mesh.n_faces());
  for (const auto v : before.mesh.vertices()) EXPECT_EQ(region.mesh.point(v), before.mesh.point(v));
  const Region after = withoutBridges(region);
  ASSERT_EQ(after.mesh.n_vertices(), before.mesh.n_vertices());
  ASSERT_EQ(after.mesh.n_faces(), before.mesh.n_faces());
  ASSERT_EQ(after.mesh.n_edges(), before.mesh.n_edges());
  for (const auto v : before.mesh.vertices()) EXPECT_EQ(after.mesh.point(v), before.mesh.point(v));
  EXPECT_EQ(after.inputTriangle, before.inputTriangle);
  EXPECT_EQ(after.curveParameter, before.curveParameter);
  EXPECT_EQ(after.corner, before.corner);
  EXPECT_TRUE(after.bridge.empty());
  for (const auto e : before.mesh.edges()) {
    const auto h = before.mesh.halfedge_handle(e, 0);
    const auto same = after.mesh.edge_handle(
        after.mesh.find_halfedge(before.mesh.from_vertex_handle(h), before.mesh.to_vertex_handle(h)));
    EXPECT_EQ(after.edgeCurve[same.idx()], before.edgeCurve[e.idx()]);
  }
}

TEST(HoleBridges, aMapKeepsItsImagesOnTheSurface) {
  Region region = regionOf(pierced(24, twoHoles, flat));
  bridged(region, 1000);
  Parametrization map;
  map.mesh = region.mesh;
  map.scale = FixedScale{20};
  map.corner.resize(map.mesh.n_halfedges());
  const auto image = [&](const SurfaceMesh& mesh, HalfedgeHandle h) {
    return map.scale.round(Eigen::Vector2d(mesh.point(mesh.from_vertex_handle(h)).head<2>()));
  };
  for (const auto h : map.mesh.halfedges())
    if (!map.mesh.is_boundary(h)) map.corner[h.idx()] = image(map.mesh, h);
  const Region surface = withoutBridges(region);
  const Parametrization cut = withoutBridges(map, region);
  verify(cut, true);
  ASSERT_EQ(cut.mesh.n_halfedges(), surface.mesh.n_halfedges());
  for (const auto h : cut.mesh.halfedges()) {
    EXPECT_EQ(cut.mesh.to_vertex_handle(h), surface.mesh.to_vertex_handle(h));
    if (!cut.mesh.is_boundary(h)) {
      EXPECT_EQ(cut.from(h), image(cut.mesh, h));
    }
  }
}

TEST(HoleBridges, alignedHolesAndEndsOfTubesStay) {
  MeshModelOptions options;
  options.features.alignBoundary = true;
  Region plate = regionOf(pierced(24, twoHoles, flat), options);
  HoleCounts counts = bridged(plate, 50);
  EXPECT_EQ(counts.bridged, 0);
  EXPECT_EQ(counts.aligned, 2);

  Region tube = regionOf(sheet(8, 5, [](double x, double y) {
    const double a = 2 * kPi * x / 8.5;  // open along one line: one loop
    return Eigen::Vector3d(std::cos(a), std::sin(a), y);
  }));
  counts = bridged(tube, 1000);
  EXPECT_EQ(counts.bridged, 0);
  EXPECT_EQ(counts.ends, 1);
}

TEST(HoleBridges, aMissingTriangleIsBridgedWithoutDoublingAnEdge) {
  // A tetrahedron without one side: the other three edges join all pairs of the loop's points.
  Region region =
      regionOf({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, 0.05}}, {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}}});
  EXPECT_EQ(bridged(region, 10).ends, 1) << "its outside is no hole";
  TriangleSoup box = cube();
  box.triangles.pop_back();
  region = regionOf(box);
  EXPECT_EQ(bridged(region, 10).bridged, 1);
  EXPECT_EQ(eulerCharacteristic(region.mesh), 2);
}

}  // namespace trimquad
