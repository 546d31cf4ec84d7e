#include "trimquad/embed/path_search.h"

#include <algorithm>
#include <map>
#include <optional>
#include <queue>
#include <tuple>
#include <variant>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

/// A vertex, or the middle of an edge or triangle that would have to be split.
using Stop = std::variant<VertexHandle, EdgeHandle, FaceHandle>;

/// A split costs as much as a detour of this part of the step to it.
constexpr double kSplitCost = 0.3;

class Search {
 public:
  Search(const SurfaceMesh& mesh, const Occupied& occupied, PatchCorner from, PatchCorner to)
      : mesh_(mesh),
        occupied_(occupied),
        from_(mesh.from_vertex_handle(from.out)),
        to_(mesh.from_vertex_handle(to.out)),
        fromSector_(sector(from)),
        toSector_(sector(to)) {}

  std::vector<Stop> run() && {
    if (from_ != to_ && joined()) return {from_, to_};
    for (const auto h : fromSector_) {
      offer({}, 0, from_, h);
      // Both corners are of one triangle, and the edge between them is taken.
      for (const auto g : toSector_)
        if (mesh_.face_handle(g) == mesh_.face_handle(h)) relax({}, 0, from_, mesh_.face_handle(h));
    }
    while (!waiting_.empty()) {
      const auto [estimate, distance, stop] = waiting_.top();
      waiting_.pop();
      if (distance > reached_.at(stop).distance) continue;
      if (stop == Stop{to_}) return way();
      expand(stop, distance);
    }
    TRIMQUAD_ASSERT(!"the inside of a patch is connected");
    return {};
  }

 private:
  struct Reached {
    double distance;
    std::optional<Stop> before;
  };
  /// Least possible length of a way through the stop, its distance from the start, the stop (A*).
  using Waiting = std::tuple<double, double, Stop>;

  /// The halfedges that leave the corner's vertex, one for each of the patch's triangles there,
  /// counter-clockwise.
  std::vector<HalfedgeHandle> sector(PatchCorner corner) const {
    std::vector<HalfedgeHandle> all;
    for (HalfedgeHandle h = corner.out;;) {
      all.push_back(h);
      const HalfedgeHandle back = mesh_.prev_halfedge_handle(h);
      if (back == corner.in) return all;
      TRIMQUAD_ASSERT(!occupied_.edge[mesh_.edge_handle(back).idx()]);
      h = mesh_.opposite_halfedge_handle(back);
    }
  }

  /// Whether a free edge joins the two corners.
  bool joined() const {
    for (std::size_t k = 1; k < fromSector_.size(); ++k)
      for (std::size_t l = 1; l < toSector_.size(); ++l)
        if (mesh_.opposite_halfedge_handle(fromSector_[k]) == toSector_[l]) return true;
    return false;
  }

  Eigen::Vector3d place(const Stop& stop) const {
    if (const auto* v = std::get_if<VertexHandle>(&stop)) return mesh_.point(*v);
    if (const auto* e = std::get_if<EdgeHandle>(&stop)) return mesh_.calc_edge_midpoint(*e);
    return mesh_.calc_face_centroid(std::get<FaceHandle>(stop));
  }

  void relax(std::optional<Stop> before, double distance, const Stop& here, const Stop& next) {
    double step = (place(here) - place(next)).norm();
    if (!std::holds_alternative<VertexHandle>(next)) step *= 1 + kSplitCost;
    const auto [found, isNew] = reached_.try_emplace(next, Reached{distance + step, before});
    if (!isNew) {
      if (found->second.distance <= distance + step) return;
      found->second = {distance + step, before};
    }
    waiting_.push({distance + step + (place(next) - place(to_)).norm(), distance + step, next});
  }

  /// From a corner of the triangle of `h`, the one that h leaves, to what is opposite, and along its sides
  /// there.
  void offer(std::optional<Stop> before, double distance, const Stop& here, HalfedgeHandle h) {
    const HalfedgeHandle far = mesh_.next_halfedge_handle(h);
    if (!occupied_.edge[mesh_.edge_handle(far).idx()]) relax(before, distance, here, mesh_.edge_handle(far));
    for (const VertexHandle v : {mesh_.from_vertex_handle(far), mesh_.to_vertex_handle(far)})
      if (!occupied_.vertex[v.idx()]) relax(before, distance, here, v);
  }

  void expand(const Stop& stop, double distance) {
    for (const auto h : toSector_)
      if (touches(stop, h)) relax(stop, distance, stop, to_);
    if (const auto* v = std::get_if<VertexHandle>(&stop)) {
      for (const auto h : mesh_.voh_range(*v)) offer(stop, distance, stop, h);
    } else if (const auto* e = std::get_if<EdgeHandle>(&stop)) {
      for (const int side : {0, 1}) {
        const HalfedgeHandle next = mesh_.next_halfedge_handle(mesh_.halfedge_handle(*e, side)),
                             last = mesh_.next_halfedge_handle(next);
        for (const HalfedgeHandle h : {next, last})
          if (!occupied_.edge[mesh_.edge_handle(h).idx()]) relax(stop, distance, stop, mesh_.edge_handle(h));
        if (!occupied_.vertex[mesh_.to_vertex_handle(next).idx()])
          relax(stop, distance, stop, mesh_.to_vertex_handle(next));
      }
    }
  }

  /// Whether the target is one step away through its triangle of `h`.
  bool touches(const Stop& stop, HalfedgeHandle h) const {
    const HalfedgeHandle far = mesh_.next_halfedge_handle(h);
    if (const auto* v = std::get_if<VertexHandle>(&stop))
      return mesh_.from_vertex_handle(far) == *v || mesh_.to_vertex_handle(far) == *v;
    if (const auto* e = std::get_if<EdgeHandle>(&stop)) return mesh_.edge_handle(far) == *e;
    return mesh_.face_handle(h) == std::get<FaceHandle>(stop);
  }

  std::vector<Stop> way() const {
    std::vector<Stop> stops;
    for (std::optional<Stop> at = to_; at; at = reached_.at(*at).before) stops.push_back(*at);
    stops.push_back(from_);
    std::reverse(stops.begin(), stops.end());
    return stops;
  }

  const SurfaceMesh& mesh_;
  const Occupied& occupied_;
  const VertexHandle from_, to_;
  const std::vector<HalfedgeHandle> fromSector_, toSector_;
  std::map<Stop, Reached> reached_;
  std::priority_queue<Waiting, std::vector<Waiting>, std::greater<>> waiting_;
};

}  // namespace

EdgePath connectCorners(const SurfaceMesh& input, RefinedMesh& refined, Occupied& occupied, PatchCorner from,
                        PatchCorner to, int& splits) {
  const auto stops = Search(refined.mesh, occupied, from, to).run();
  EdgePath path;
  for (const Stop& stop : stops) {
    if (const auto* v = std::get_if<VertexHandle>(&stop)) {
      path.push_back(*v);
      continue;
    }
    ++splits;
    if (const auto* e = std::get_if<EdgeHandle>(&stop))
      path.push_back(splitInMiddle(input, refined, *e));
    else
      path.push_back(splitInMiddle(input, refined, std::get<FaceHandle>(stop)));
  }
  occupied.grow(refined.mesh);
  for (std::size_t k = 0; k + 1 < path.size(); ++k)
    TRIMQUAD_ASSERT(refined.mesh.find_halfedge(path[k], path[k + 1]).is_valid());
  return path;
}

}  // namespace trimquad
