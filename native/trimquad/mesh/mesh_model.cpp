#include "trimquad/mesh/mesh_model.h"

#include <algorithm>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <string>

#include "trimquad/base/error.h"
#include "trimquad/mesh/aabb_tree.h"
#include "trimquad/mesh/border_graph.h"
#include "trimquad/mesh/edge_choice.h"
#include "trimquad/mesh/polyline_curve.h"
#include "trimquad/mesh/sharp_edges.h"
#include "trimquad/mesh/side_gluing.h"
#include "trimquad/mesh/split_triangles.h"

namespace trimquad {
namespace {

/// The shortest sharp curves that count, in quad edges.
constexpr double kShortestBorder = 0.5, kShortestAligned = 2;

double radians(double degrees) {
  return degrees * std::numbers::pi / 180;
}

/// The vertices at the wanted points of the surface, put in where there are none.
std::vector<VertexHandle> insertPoints(SurfaceMesh& mesh, const FeatureOptions& options,
                                       std::vector<int>& input) {
  std::vector<VertexHandle> inserted;
  for (const Eigen::Vector3d& p : options.points) {
    std::optional<FaceHandle> nearest;
    Eigen::Vector3d barycentric;
    double least = std::numeric_limits<double>::infinity();
    for (const auto f : mesh.faces()) {
      const auto h = mesh.halfedge_handle(f);
      const Eigen::Vector3d &a = mesh.point(mesh.from_vertex_handle(h)),
                            &b = mesh.point(mesh.to_vertex_handle(h)),
                            &c = mesh.point(mesh.to_vertex_handle(mesh.next_halfedge_handle(h)));
      const Eigen::Vector3d w = closestOnTriangle(p, a, b, c);
      const double square = (w[0] * a + w[1] * b + w[2] * c - p).squaredNorm();
      if (square < least) nearest = f, barycentric = w, least = square;
    }
    if (!nearest || !(std::sqrt(least) <= kFeaturePointReach * options.quadLength))
      throw inputError("options",
                       "a feature point is " + std::to_string(std::sqrt(least)) +
                           " away from the surface, over half a quad; give a point on it",
                       {}, p);
    inserted.push_back(insertPoint(mesh, *nearest, barycentric, input));
  }
  return inserted;
}

/// Cuts one mesh into the regions of a model.
class ModelCut {
 public:
  /// \param input  by triangle
  ModelCut(const SurfaceMesh& mesh, const MeshModelOptions& options, const std::vector<int>& input,
           const std::vector<VertexHandle>& featurePoints, const Progress& progress)
      : mesh_(mesh),
        options_(options.features),
        input_(input),
        progress_(progress),
        component_(partsBetween(mesh, std::vector<bool>(mesh.n_edges(), false))),
        part_(options_.sharp == FeatureOptions::Sharp::Trim ? partsBetween(mesh, sharp(kShortestBorder))
                                                            : component_),
        border_(mesh, bordersBetween(mesh, part_), radians(options.cornerAngle)),
        point_(mesh.n_vertices(), false) {
    for (const auto v : featurePoints) point_[v.idx()] = true;
  }

  Model run() {
    addCorners();
    addCurves();
    chooseAligned();
    addRegions();
    measure();
    return std::move(model_);
  }

 private:
  std::vector<bool> sharp(double shortest) const {
    return sharpEdges(
        mesh_, {.angle = radians(options_.angle), .quadLength = options_.quadLength, .shortest = shortest});
  }

  void chooseAligned() {
    aligned_ = options_.sharp == FeatureOptions::Sharp::Align ? sharp(kShortestAligned)
                                                              : std::vector<bool>(mesh_.n_edges(), false);
    const auto chosen = chosenEdges(mesh_, model_.curves, curve_, options_.align);
    const auto freed = chosenEdges(mesh_, model_.curves, curve_, options_.free);
    for (const auto e : mesh_.edges()) {
      const bool byDefault = aligned_[e.idx()] || (options_.alignBoundary && border_.isBorder(e));
      aligned_[e.idx()] = (byDefault || chosen[e.idx()]) && !freed[e.idx()];
    }
  }

  void addCorners() {
    corner_.resize(mesh_.n_vertices());
    for (const auto v : mesh_.vertices()) {
      if (!border_.isCorner(v)) continue;
      corner_[v.idx()] = CornerId{int(model_.corners.size())};
      model_.corners.push_back(mesh_.point(v));
    }
  }

  void addCurves() {
    curve_.resize(mesh_.n_edges());
    parameter_.assign(mesh_.n_vertices(), 0);
    std::vector<int> loopOf(mesh_.n_edges(), 0);
    const auto loops = boundaryLoops(mesh_);
    for (int k = 0; k < int(loops.size()); ++k)
      for (const auto h : loops[k]) loopOf[mesh_.edge_handle(h).idx()] = k;
    int features = 0;
    for (const auto& chain : border_.chains()) {
      progress_.check();
      const CurveId id{int(model_.curves.size())};
      const HalfedgeHandle front = chain.halfedges.front(), back = chain.halfedges.back();
      std::vector<Eigen::Vector3d> points{mesh_.point(mesh_.from_vertex_handle(front))};
      for (const auto h : chain.halfedges) {
        points.push_back(mesh_.point(mesh_.to_vertex_handle(h)));
        curve_[mesh_.edge_handle(h).idx()] = id;
      }
      const auto polyline = std::make_shared<PolylineCurve>(std::move(points));
      for (std::size_t i = 1; i < chain.halfedges.size(); ++i)
        parameter_[mesh_.from_vertex_handle(chain.halfedges[i]).idx()] = polyline->parameters()[i];
      const EdgeHandle e = mesh_.edge_handle(front);
      const std::string name = mesh_.is_boundary(e) ? "loop:" + std::to_string(loopOf[e.idx()])
                                                    : "feature:" + std::to_string(features++);
      model_.curves.push_back({polyline, *corner_[mesh_.from_vertex_handle(front).idx()],
                               *corner_[mesh_.to_vertex_handle(back).idx()], name});
    }
  }

  void addRegions() {
    std::map<int, std::map<int, std::vector<FaceHandle>>> parts;  // component, part
    std::map<int, bool> closed;
    for (const auto f : mesh_.faces()) {
      parts[component_[f.idx()]][part_[f.idx()]].push_back(f);
      auto& shut = closed.try_emplace(component_[f.idx()], true).first->second;
      shut = shut && !mesh_.is_boundary(f);
    }
    int solids = 0;
    for (const auto& [component, members] : parts) {
      auto& shell = model_.shells.emplace_back();
      if (closed[component]) shell.solid = solids++;
      std::string name = "component " + std::to_string(model_.shells.size() - 1);
      int number = 0;
      for (const auto& [part, faces] : members) {
        progress_.check();
        shell.regions.push_back(int(model_.regions.size()));
        model_.regions.push_back(region(faces));
        model_.regions.back().name = members.size() == 1 ? name : name + " part " + std::to_string(number++);
      }
    }
  }

  /// The triangles of a region with vertices of their own. A vertex in which the region touches itself
  /// becomes several.
  Region region(const std::vector<FaceHandle>& faces) const {
    TriangleSoup soup;
    std::vector<int> whole;  // by vertex: its number in the whole mesh
    for (const auto f : faces)
      for (const auto v : mesh_.fv_range(f)) whole.push_back(v.idx());
    std::sort(whole.begin(), whole.end());
    whole.erase(std::unique(whole.begin(), whole.end()), whole.end());
    for (const int v : whole) soup.points.push_back(mesh_.point(VertexHandle(v)));
    for (const auto f : faces) {
      auto& corners = soup.triangles.emplace_back();
      int k = 0;
      for (const auto v : mesh_.fv_range(f))
        corners[k++] = int(std::lower_bound(whole.begin(), whole.end(), v.idx()) - whole.begin());
    }
    whole = splitTouchingFans(soup, whole);

    Region result;
    result.mesh = buildSurfaceMesh(soup);
    for (const int v : whole) {
      result.curveParameter.push_back(parameter_[v]);
      result.corner.push_back(corner_[v]);
    }
    for (const auto f : faces) result.inputTriangle.push_back(input_[f.idx()]);
    result.edgeCurve.resize(result.mesh.n_edges());
    for (const auto e : result.mesh.edges()) {
      const auto h = result.mesh.halfedge_handle(e, 0);
      const VertexHandle a(whole[result.mesh.from_vertex_handle(h).idx()]);
      const VertexHandle b(whole[result.mesh.to_vertex_handle(h).idx()]);
      const EdgeHandle original = mesh_.edge_handle(mesh_.find_halfedge(a, b));
      if (result.mesh.is_boundary(e)) result.edgeCurve[e.idx()] = curve_[original.idx()];
      if (aligned_[original.idx()]) result.aligned.push_back(e);
    }
    for (const auto v : result.mesh.vertices())
      if (point_[whole[v.idx()]]) result.featurePoints.push_back(v);
    splitConstrainedTriangles(result);
    return result;
  }

  /// Gives each fan of triangles around a vertex its own copy of it; returns `label` by new vertex.
  static std::vector<int> splitTouchingFans(TriangleSoup& soup, const std::vector<int>& label) {
    std::vector<int> identity(soup.points.size());
    std::iota(identity.begin(), identity.end(), 0);
    const std::vector<int> fan = cornerFans(soup, glueSides(soup, identity));
    std::vector<std::array<int, 2>> order;  // vertex, fan
    for (int c = 0; c < int(fan.size()); ++c)
      if (fan[c] == c) order.push_back({soup.triangles[c / 3][c % 3], c});
    std::sort(order.begin(), order.end());
    std::vector<int> number(fan.size()), labels;
    std::vector<Eigen::Vector3d> points;
    for (const auto& [v, f] : order) {
      number[f] = int(points.size());
      points.push_back(soup.points[v]);
      labels.push_back(label[v]);
    }
    for (int c = 0; c < int(fan.size()); ++c) soup.triangles[c / 3][c % 3] = number[fan[c]];
    soup.points = std::move(points);
    return labels;
  }

  void measure() {
    Eigen::Vector3d low = mesh_.point(VertexHandle(0)), high = low;
    for (const auto v : mesh_.vertices()) {
      low = low.cwiseMin(mesh_.point(v));
      high = high.cwiseMax(mesh_.point(v));
    }
    model_.diagonal = (high - low).norm();
  }

  const SurfaceMesh& mesh_;
  const FeatureOptions& options_;
  const std::vector<int>& input_;  ///< by triangle
  const Progress& progress_;
  const std::vector<int> component_,
      part_;  ///< by triangle: the smallest one of its component, of its region
  const BorderGraph border_;
  std::vector<bool> point_;                      ///< by vertex: whether it is a feature point
  std::vector<bool> aligned_;                    ///< by edge
  std::vector<std::optional<CornerId>> corner_;  ///< by vertex
  std::vector<std::optional<CurveId>> curve_;    ///< by edge
  std::vector<double> parameter_;                ///< by vertex
  Model model_;
};

}  // namespace

Model meshModel(const TriangleSoup& soup, const MeshModelOptions& options, const Progress& progress,
                std::vector<int> input) {
  SurfaceMesh mesh = buildSurfaceMesh(soup);
  if (mesh.n_faces() == 0) throw inputError("tessellate", "the mesh has no triangles");
  progress.check();
  if (!options.features.vertices.empty())
    throw inputError("options", "a mesh has no vertices with names; give feature points as x,y,z",
                     options.features.vertices.front());
  if (input.empty()) {
    input.resize(mesh.n_faces());
    std::iota(input.begin(), input.end(), 0);
  }
  TRIMQUAD_ASSERT(input.size() == mesh.n_faces());
  const auto points = insertPoints(mesh, options.features, input);
  return ModelCut(mesh, options, input, points, progress).run();
}

}  // namespace trimquad
