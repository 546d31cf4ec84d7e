#include "trimquad/embed/path_search.h"

#include <algorithm>
#include <functional>

#include "trimquad/base/error.h"
#include "trimquad/mesh/collapse_edge.h"

namespace trimquad {
namespace {

/// A split costs as much as a detour of this part of the step to it.
constexpr double kSplitCost = 0.3;

}  // namespace

EdgePath PathSearch::connect(PatchCorner from, PatchCorner to, int& splits) {
  start(from, to);
  EdgePath path;
  for (const Stop& stop : stops()) {
    if (stop.kind == Stop::Vertex) {
      path.push_back(VertexHandle(stop.index));
      continue;
    }
    ++splits;
    path.push_back(stop.kind == Stop::Side
                       ? splitInMiddle(input_, refined_, mesh_.edge_handle(HalfedgeHandle(stop.index)))
                       : splitInMiddle(input_, refined_, FaceHandle(stop.index)));
  }
  occupied_.grow(mesh_);
  for (std::size_t k = 0; k + 1 < path.size(); ++k)
    TRIMQUAD_ASSERT(halfedgeBetween(mesh_, path[k], path[k + 1]).is_valid());
  return path;
}

void PathSearch::start(PatchCorner from, PatchCorner to) {
  from_ = mesh_.from_vertex_handle(from.out);
  to_ = mesh_.from_vertex_handle(to.out);
  goal_ = mesh_.point(to_);
  fromSector_ = sector(from);
  toSector_ = sector(to);
  waiting_.clear();
  reached_.clear();
  numbers_[Stop::Vertex].resize(mesh_.n_vertices());
  numbers_[Stop::Side].resize(mesh_.n_halfedges());
  numbers_[Stop::Triangle].resize(mesh_.n_faces());
}

/// The halfedges that leave the corner's vertex, one for each of the patch's triangles there,
/// counter-clockwise.
std::vector<HalfedgeHandle> PathSearch::sector(PatchCorner corner) const {
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
bool PathSearch::joined() const {
  for (std::size_t k = 1; k < fromSector_.size(); ++k)
    for (std::size_t l = 1; l < toSector_.size(); ++l)
      if (mesh_.opposite_halfedge_handle(fromSector_[k]) == toSector_[l]) return true;
  return false;
}

std::vector<PathSearch::Stop> PathSearch::stops() {
  if (from_ != to_ && joined()) return {stopAt(from_), stopAt(to_)};
  const Eigen::Vector3d origin = mesh_.point(from_);
  for (const auto h : fromSector_) {
    offer({}, 0, origin, h);
    // Both corners are of one triangle, and the edge between them is taken.
    for (const auto g : toSector_)
      if (mesh_.face_handle(g) == mesh_.face_handle(h)) relax({}, 0, origin, stopAt(mesh_.face_handle(h)));
  }
  while (!waiting_.empty()) {
    std::pop_heap(waiting_.begin(), waiting_.end(), std::greater<>());
    const auto [estimate, distance, stop] = waiting_.back();
    waiting_.pop_back();
    if (distance > reached(stop)->distance) continue;
    if (stop == stopAt(to_)) return way();
    expand(stop, distance);
  }
  TRIMQUAD_ASSERT(!"the inside of a patch is connected");
  return {};
}

Eigen::Vector3d PathSearch::place(const Stop& stop) const {
  switch (stop.kind) {
    case Stop::Vertex:
      return mesh_.point(VertexHandle(stop.index));
    case Stop::Side:
      return mesh_.calc_edge_midpoint(HalfedgeHandle(stop.index));
    case Stop::Triangle:
      break;
  }
  return mesh_.calc_face_centroid(FaceHandle(stop.index));
}

void PathSearch::relax(std::optional<Stop> before, double distance, const Eigen::Vector3d& here,
                       const Stop& next) {
  const Eigen::Vector3d there = place(next);
  double step = (here - there).norm();
  if (next.kind != Stop::Vertex) step *= 1 + kSplitCost;
  if (Reached* known = reached(next)) {
    if (known->distance <= distance + step) return;
    *known = {next, distance + step, before};
  } else {
    numbers_[next.kind][std::size_t(next.index)] = int(reached_.size());
    reached_.push_back({next, distance + step, before});
  }
  waiting_.emplace_back(distance + step + (there - goal_).norm(), distance + step, next);
  std::push_heap(waiting_.begin(), waiting_.end(), std::greater<>());
}

/// From a corner of the triangle of `h`, the one that h leaves, to what is opposite, and along its sides
/// there.
void PathSearch::offer(std::optional<Stop> before, double distance, const Eigen::Vector3d& here,
                       HalfedgeHandle h) {
  const HalfedgeHandle far = mesh_.next_halfedge_handle(h);
  if (!occupied_.edge[mesh_.edge_handle(far).idx()]) relax(before, distance, here, stopAt(far));
  for (const VertexHandle v : {mesh_.from_vertex_handle(far), mesh_.to_vertex_handle(far)})
    if (!occupied_.vertex[v.idx()]) relax(before, distance, here, stopAt(v));
}

void PathSearch::expand(const Stop& stop, double distance) {
  const Eigen::Vector3d here = place(stop);
  for (const auto h : toSector_)
    if (touches(stop, h)) relax(stop, distance, here, stopAt(to_));
  if (stop.kind == Stop::Vertex) {
    for (const auto h : mesh_.voh_range(VertexHandle(stop.index))) offer(stop, distance, here, h);
  } else if (stop.kind == Stop::Side) {
    const HalfedgeHandle next =
        mesh_.next_halfedge_handle(mesh_.opposite_halfedge_handle(HalfedgeHandle(stop.index)));
    for (const HalfedgeHandle h : {next, mesh_.next_halfedge_handle(next)})
      if (!occupied_.edge[mesh_.edge_handle(h).idx()]) relax(stop, distance, here, stopAt(h));
    if (const VertexHandle v = mesh_.to_vertex_handle(next); !occupied_.vertex[v.idx()])
      relax(stop, distance, here, stopAt(v));
  }
}

/// Whether the target is one step away through its triangle of `h`.
bool PathSearch::touches(const Stop& stop, HalfedgeHandle h) const {
  const HalfedgeHandle far = mesh_.next_halfedge_handle(h);
  switch (stop.kind) {
    case Stop::Vertex:
      return mesh_.from_vertex_handle(far).idx() == stop.index ||
             mesh_.to_vertex_handle(far).idx() == stop.index;
    case Stop::Side:
      return mesh_.opposite_halfedge_handle(far).idx() == stop.index;
    case Stop::Triangle:
      break;
  }
  return mesh_.face_handle(h).idx() == stop.index;
}

/// What is known of the stop, if it was reached. (Numbers of earlier searches do not match.)
PathSearch::Reached* PathSearch::reached(const Stop& stop) {
  const auto number = std::size_t(numbers_[stop.kind][std::size_t(stop.index)]);
  return number < reached_.size() && reached_[number].stop == stop ? &reached_[number] : nullptr;
}

std::vector<PathSearch::Stop> PathSearch::way() {
  std::vector<Stop> stops;
  for (std::optional<Stop> at = stopAt(to_); at; at = reached(*at)->before) stops.push_back(*at);
  stops.push_back(stopAt(from_));
  std::reverse(stops.begin(), stops.end());
  return stops;
}

}  // namespace trimquad
