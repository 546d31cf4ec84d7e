#include "trimquad/mesh/sharp_edges.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>

#include "trimquad/base/disjoint_sets.h"

namespace trimquad {
namespace {

using Eigen::Vector3d;

constexpr double kBlunt = 0.5;                           ///< share of the angle over which a curve goes on
constexpr double kStraightOn = std::numbers::pi / 4;     ///< largest turn of a curve that goes on
constexpr double kKink = std::numbers::pi / 3;           ///< largest turn inside one curve
constexpr double kSharpAnywhere = std::numbers::pi / 3;  ///< folds over this stand out of anything
constexpr double kContrast = 2;                          ///< folds stand out of so much smaller ones
constexpr double kAround =
    0.8;  ///< share of the edges around that are not on sharp curves where there are any
constexpr double kFacet = 0.5;    ///< quad edges: smaller triangles are sampling
constexpr double kWideFacet = 2;  ///< quad edges: triangles that high are shape, whatever is around
constexpr double kFlatContrast =
    8;                          ///< folds between facets stand out of surfaces so much flatter in the main
constexpr double kMain = 0.65;  ///< share of the edges around that are "in the main"
constexpr double kOpenEnd = 2;  ///< curves that end openly must be so many times longer
constexpr int kBridge = 2;      ///< edges
constexpr int kRings = 2;       ///< how many edges around an edge its surroundings reach
constexpr double kRounding = 1e-9;  ///< radians

Vector3d areaNormal(const SurfaceMesh& mesh, HalfedgeHandle h) {
  const Vector3d &a = mesh.point(mesh.from_vertex_handle(h)), &b = mesh.point(mesh.to_vertex_handle(h)),
                 &c = mesh.point(mesh.to_vertex_handle(mesh.next_halfedge_handle(h)));
  return (b - a).cross(c - a);
}

double turn(const SurfaceMesh& mesh, HalfedgeHandle arriving, HalfedgeHandle leaving) {
  const Vector3d a = mesh.calc_edge_vector(arriving), b = mesh.calc_edge_vector(leaving);
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// The value that the given share of the values does not exceed. Reorders them.
double quantile(std::vector<double>& values, double share) {
  const auto at = values.begin() + long(share * double(values.size()));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

class SharpCurves {
 public:
  SharpCurves(const SurfaceMesh& mesh, const SharpEdgeOptions& options) : mesh_(mesh), options_(options) {
    for (const auto e : mesh.edges()) fold_.push_back(foldAngle(mesh, e));
    for (const double fold : fold_) {
      const double size = std::abs(fold);
      sharp_.push_back(size > options.angle + kRounding && size <= options.most + kRounding);
    }
  }

  std::vector<bool> run() {
    if (options_.quadLength > 0 && options_.follow) dropFaint();
    if (options_.follow) followBlunt();
    if (options_.shortest * options_.quadLength > 0) dropShort();
    return std::move(sharp_);
  }

 private:
  bool isSharp(HalfedgeHandle h) const { return sharp_[mesh_.edge_handle(h).idx()]; }
  double fold(HalfedgeHandle h) const { return fold_[mesh_.edge_handle(h).idx()]; }
  bool sameSide(HalfedgeHandle a, HalfedgeHandle b) const { return (fold(a) > 0) == (fold(b) > 0); }

  std::vector<HalfedgeHandle> sharpFrom(VertexHandle v) const {
    std::vector<HalfedgeHandle> out;
    for (const auto h : mesh_.voh_range(v))
      if (isSharp(h)) out.push_back(h);
    return out;
  }

  /// Edges that are no sharper than the surface around them bends belong to a curved surface or to noise.
  void dropFaint() {
    std::vector<bool> standsOut = sharp_;
    for (const auto e : mesh_.edges())
      if (sharp_[e.idx()]) standsOut[e.idx()] = isProminent(e);
    sharp_ = std::move(standsOut);
  }

  bool isProminent(EdgeHandle e) const {
    const double fold = std::abs(fold_[e.idx()]);
    const double width = facetWidth(e) / options_.quadLength;
    if (fold > kSharpAnywhere || width >= kWideFacet) return true;
    std::vector<double> around = foldsAround(e);
    return fold >= kContrast * quantile(around, kAround) ||
           (width >= kFacet && fold >= kFlatContrast * quantile(around, kMain));
  }

  /// The smaller height of the two triangles over the edge.
  double facetWidth(EdgeHandle e) const {
    double width = std::numeric_limits<double>::infinity();
    for (const int side : {0, 1})
      width = std::min(width, areaNormal(mesh_, mesh_.halfedge_handle(e, side)).norm());
    return width / mesh_.calc_edge_length(e);
  }

  /// How sharp the edges within a few edges of an edge are.
  std::vector<double> foldsAround(EdgeHandle e) const {
    std::set<VertexHandle> near;
    for (const int side : {0, 1}) near.insert(mesh_.to_vertex_handle(mesh_.halfedge_handle(e, side)));
    for (int ring = 0; ring < kRings; ++ring) {
      std::set<VertexHandle> wider = near;
      for (const auto v : near)
        for (const auto w : mesh_.vv_range(v)) wider.insert(w);
      near = std::move(wider);
    }
    std::vector<double> folds;
    for (const auto v : near)
      for (const auto h : mesh_.voh_range(v))
        if (v < mesh_.to_vertex_handle(h) && near.count(mesh_.to_vertex_handle(h)))
          folds.push_back(std::abs(fold(h)));
    return folds;
  }

  /// Every curve that ends goes on straight ahead as long as the surface bends there.
  void followBlunt() {
    std::vector<HalfedgeHandle> ends;  // arriving
    for (const auto v : mesh_.vertices())
      if (const auto out = sharpFrom(v); out.size() == 1)
        ends.push_back(mesh_.opposite_halfedge_handle(out[0]));
    for (const auto end : ends)
      if (sharpFrom(mesh_.to_vertex_handle(end)).size() == 1) follow(end);
  }

  /// Goes on over edges that stand out, and over up to kBridge others if one that does, or another curve,
  /// comes after them: where curves meet, none stands out of the others.
  void follow(HalfedgeHandle arriving) {
    std::vector<EdgeHandle> pending;
    while (const auto further = straightOn(arriving)) {
      const EdgeHandle e = mesh_.edge_handle(*further);
      pending.push_back(e);
      arriving = *further;
      const bool reached = !sharpFrom(mesh_.to_vertex_handle(arriving)).empty();
      if (reached || !(options_.quadLength > 0) || isProminent(e)) {
        for (const auto taken : pending) sharp_[taken.idx()] = true;
        pending.clear();
      }
      if (reached || int(pending.size()) > kBridge) return;
    }
  }

  std::optional<HalfedgeHandle> straightOn(HalfedgeHandle arriving) const {
    std::optional<HalfedgeHandle> best;
    for (const auto h : mesh_.voh_range(mesh_.to_vertex_handle(arriving))) {
      if (isSharp(h) || h == mesh_.opposite_halfedge_handle(arriving) || !sameSide(h, arriving)) continue;
      if (std::abs(fold(h)) <= kBlunt * options_.angle || turn(mesh_, arriving, h) > kStraightOn) continue;
      if (!best || std::abs(fold(h)) > std::abs(fold(*best))) best = h;
    }
    return best;
  }

  void dropShort() {
    DisjointSets curves(mesh_.n_edges());
    for (const auto v : mesh_.vertices()) {
      const auto out = sharpFrom(v);
      for (std::size_t i = 0; i < out.size(); ++i)
        for (std::size_t j = i + 1; j < out.size(); ++j) {
          if (!sameSide(out[i], out[j])) continue;
          const double kink = turn(mesh_, mesh_.opposite_halfedge_handle(out[i]), out[j]);
          if (out.size() == 2 || kink <= kKink)
            curves.unite(mesh_.edge_handle(out[i]).idx(), mesh_.edge_handle(out[j]).idx());
        }
    }
    std::map<int, std::vector<EdgeHandle>> members;
    for (const auto e : mesh_.edges())
      if (sharp_[e.idx()]) members[curves.root(e.idx())].push_back(e);
    std::vector<bool> kept(mesh_.n_edges(), false), onKept(mesh_.n_vertices(), false);
    const auto keep = [&](const std::vector<EdgeHandle>& curve) {
      for (const auto e : curve) kept[e.idx()] = true;
    };
    std::vector<const std::vector<EdgeHandle>*> rest;
    for (const auto& [root, curve] : members) {
      const double wanted = (endsOpenly(curve) ? kOpenEnd : 1) * options_.shortest * options_.quadLength;
      if (extent(curve) < wanted) {
        rest.push_back(&curve);
        continue;
      }
      keep(curve);
      for (const auto e : curve)
        for (const auto v : {mesh_.to_vertex_handle(mesh_.halfedge_handle(e, 0)),
                             mesh_.to_vertex_handle(mesh_.halfedge_handle(e, 1))})
          onKept[v.idx()] = true;
    }
    for (const auto* curve : rest)
      if (joins(*curve, onKept)) keep(*curve);
    sharp_ = std::move(kept);
  }

  /// Whether the curve ends somewhere on the surface instead of meeting others.
  bool endsOpenly(const std::vector<EdgeHandle>& curve) const {
    for (const auto e : curve)
      for (const int side : {0, 1}) {
        const auto v = mesh_.to_vertex_handle(mesh_.halfedge_handle(e, side));
        if (!mesh_.is_boundary(v) && sharpFrom(v).size() == 1) return true;
      }
    return false;
  }

  double extent(const std::vector<EdgeHandle>& curve) const {
    Eigen::AlignedBox3d box;
    for (const auto e : curve) {
      box.extend(mesh_.point(mesh_.to_vertex_handle(mesh_.halfedge_handle(e, 0))));
      box.extend(mesh_.point(mesh_.to_vertex_handle(mesh_.halfedge_handle(e, 1))));
    }
    return box.diagonal().norm();
  }

  /// Whether the curve has two or more ends, all of them on kept curves.
  bool joins(const std::vector<EdgeHandle>& curve, const std::vector<bool>& onKept) const {
    std::map<VertexHandle, int> degree;
    for (const auto e : curve) {
      ++degree[mesh_.to_vertex_handle(mesh_.halfedge_handle(e, 0))];
      ++degree[mesh_.to_vertex_handle(mesh_.halfedge_handle(e, 1))];
    }
    int ends = 0;
    for (const auto& [v, d] : degree) {
      if (d != 1) continue;
      ++ends;
      if (!onKept[v.idx()]) return false;
    }
    return ends >= 2;
  }

  const SurfaceMesh& mesh_;
  const SharpEdgeOptions& options_;
  std::vector<double> fold_;  ///< by edge
  std::vector<bool> sharp_;   ///< by edge
};

}  // namespace

double foldAngle(const SurfaceMesh& mesh, EdgeHandle e) {
  if (mesh.is_boundary(e)) return 0;
  const auto h = mesh.halfedge_handle(e, 0), o = mesh.halfedge_handle(e, 1);
  const Vector3d n = areaNormal(mesh, h), m = areaNormal(mesh, o);
  const double angle = std::atan2(n.cross(m).norm(), n.dot(m));
  const Vector3d across = mesh.point(mesh.to_vertex_handle(mesh.next_halfedge_handle(o))) -
                          mesh.point(mesh.from_vertex_handle(h));
  return across.dot(n) > 0 ? -angle : angle;
}

std::vector<bool> sharpEdges(const SurfaceMesh& mesh, const SharpEdgeOptions& options) {
  return SharpCurves(mesh, options).run();
}

}  // namespace trimquad
