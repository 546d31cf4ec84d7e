#include "trimquad/mesh/hole_cap.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <tuple>

#include "trimquad/base/error.h"
#include "trimquad/mesh/polyline_curve.h"
#include "trimquad/mesh/remesh.h"
#include "trimquad/mesh/triangle_surface.h"

namespace trimquad {
namespace {

using Eigen::Vector3d;

/// A triangle whose area is this part of its squared sides or less has none: what rounding leaves of one with
/// its corners on a line.
constexpr double kNoTriangle = 1e-9;

double areaOf(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  return 0.5 * (b - a).cross(c - a).norm();
}

bool hasArea(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const double sides = (b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm();
  return areaOf(a, b, c) > kNoTriangle * sides;
}

/// The triangulation itself as a surface that asks for no shorter edges anywhere.
class CapSurface : public TrueSurface {
 public:
  explicit CapSurface(const SurfaceMesh& mesh) : triangles_(mesh) {}
  Foot closest(const Vector3d& p) const override { return triangles_.closest(p); }
  Foot closestFacing(const Vector3d& p, const Vector3d& facing) const override {
    return triangles_.closestFacing(p, facing);
  }
  Curvature curvature(const Vector3d&) const override { return {Vector3d::UnitX(), Vector3d::UnitY(), 0, 0}; }

 private:
  TriangleSurface triangles_;
};

/// The triangulated loop as a region of a model in which every point of the loop is a corner, every side a
/// curve.
Model capModel(const std::vector<Vector3d>& loop, std::vector<std::array<int, 3>> triangles) {
  const int n = int(loop.size());
  Model model;
  Region& cap = model.regions.emplace_back();
  cap.name = "cap";
  cap.mesh = buildSurfaceMesh({loop, std::move(triangles)});
  cap.surface = std::make_shared<CapSurface>(cap.mesh);
  cap.edgeCurve.resize(cap.mesh.n_edges());
  cap.curveParameter.assign(loop.size(), 0);
  model.corners = loop;
  for (int k = 0; k < n; ++k) {
    const int next = (k + 1) % n;
    model.curves.push_back(
        {std::make_shared<PolylineCurve>(std::vector{loop[k], loop[next]}), CornerId{k}, CornerId{next}, ""});
    const auto side = cap.mesh.find_halfedge(VertexHandle(k), VertexHandle(next));
    cap.edgeCurve[cap.mesh.edge_handle(side).idx()] = CurveId{k};
    cap.corner.push_back(CornerId{k});
  }
  return model;
}

}  // namespace

std::vector<std::array<int, 3>> leastAreaTriangulation(const std::vector<Vector3d>& loop,
                                                       const Progress& progress) {
  const int n = int(loop.size());
  TRIMQUAD_ASSERT(n >= 3);
  using Cost = std::pair<int, double>;  // triangles without area, area
  std::vector<Cost> least(std::size_t(n) * n, Cost{0, 0});
  std::vector<int> apex(std::size_t(n) * n, 0);
  const auto at = [n](int i, int j) { return std::size_t(i) * n + j; };
  for (int span = 2; span < n; ++span) {
    progress.check();
    for (int i = 0; i + span < n; ++i) {
      const int k = i + span;
      Cost best{std::numeric_limits<int>::max(), 0};
      for (int j = i + 1; j < k; ++j) {
        const Cost &left = least[at(i, j)], &right = least[at(j, k)];
        Cost cost{left.first + right.first, left.second + right.second};
        if (cost >= best) continue;
        cost.first += !hasArea(loop[i], loop[j], loop[k]);
        cost.second += areaOf(loop[i], loop[j], loop[k]);
        if (cost < best) best = cost, apex[at(i, k)] = j;
      }
      least[at(i, k)] = best;
    }
  }
  std::vector<std::array<int, 3>> triangles;
  std::vector<std::pair<int, int>> open{{0, n - 1}};
  while (!open.empty()) {
    const auto [i, k] = open.back();
    open.pop_back();
    if (k - i < 2) continue;
    const int j = apex[at(i, k)];
    triangles.push_back({i, j, k});
    open.push_back({i, j});
    open.push_back({j, k});
  }
  return triangles;
}

TriangleSoup holeCap(const std::vector<Vector3d>& loop, double edgeLength, const Progress& progress) {
  Model model = capModel(loop, leastAreaTriangulation(loop, progress));
  std::vector<std::vector<double>> division;
  for (const auto& side : model.curves) division.push_back({side.curve->first(), side.curve->last()});
  Region& cap = model.regions.front();
  remesh(cap, model, division, {edgeLength, edgeLength}, progress);
  TriangleSoup soup;
  for (const auto v : cap.mesh.vertices()) soup.points.push_back(cap.mesh.point(v));
  for (const auto f : cap.mesh.faces()) {
    const auto h = cap.mesh.halfedge_handle(f);
    const auto& corners = soup.triangles.emplace_back(
        std::array{cap.mesh.from_vertex_handle(h).idx(), cap.mesh.to_vertex_handle(h).idx(),
                   cap.mesh.to_vertex_handle(cap.mesh.next_halfedge_handle(h)).idx()});
    if (!hasArea(soup.points[corners[0]], soup.points[corners[1]], soup.points[corners[2]]))
      throw stageError("bridge", "a hole is too narrow to be bridged; choose a smaller --fill-holes", "",
                       soup.points[corners[0]]);
  }
  for (std::size_t k = 0; k < loop.size(); ++k) TRIMQUAD_ASSERT(soup.points[k] == loop[k]);
  return soup;
}

}  // namespace trimquad
