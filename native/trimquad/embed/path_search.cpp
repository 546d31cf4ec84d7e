#include "trimquad/embed/path_search.h"

#include <algorithm>
#include <functional>

#include "trimquad/base/error.h"
#include "trimquad/mesh/collapse_edge.h"

namespace trimquad {
namespace {

/// A split costs as much as a detour of so many times the step to it: paths that are snapped to a mesh go to
/// and fro and are longer than need be, but cutting them straight is not worth their splits.
constexpr double kSplitCost = 2;

}  // namespace

PathSearch::Way PathSearch::connect(PatchCorner from, const std::vector<Landing>& landings, int& splits) {
  start(from, landings);
  for (const auto h : sector(from)) {
    offer({}, 0, mesh_.point(from_), h);
    offerThroughTriangle(h);
  }
  const std::vector<Stop> stops = search();
  Way way{{from_}, *landingOf(stops.back())};
  for (const Stop& stop : stops) {
    if (stop.kind == Stop::Vertex) {
      way.path.push_back(VertexHandle(stop.index));
      continue;
    }
    ++splits;
    way.path.push_back(stop.kind == Stop::Side
                           ? splitInMiddle(input_, refined_, mesh_.edge_handle(HalfedgeHandle(stop.index)))
                           : splitInMiddle(input_, refined_, FaceHandle(stop.index)));
  }
  occupied_.grow(mesh_);
  for (std::size_t k = 0; k + 1 < way.path.size(); ++k)
    TRIMQUAD_ASSERT(halfedgeBetween(mesh_, way.path[k], way.path[k + 1]).is_valid());
  return way;
}

void PathSearch::start(PatchCorner from, const std::vector<Landing>& landings) {
  from_ = mesh_.from_vertex_handle(from.out);
  landings_ = landings;
  landingNumbers_.resize(mesh_.n_vertices());
  for (std::size_t k = 0; k < landings.size(); ++k)
    landingNumbers_[mesh_.from_vertex_handle(landings[k].corner.out).idx()] = k;
  goal_ = mesh_.point(mesh_.from_vertex_handle(landings.back().corner.out));
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

/// The stops after the start, the last one a landing.
std::vector<PathSearch::Stop> PathSearch::search() {
  while (!waiting_.empty()) {
    std::pop_heap(waiting_.begin(), waiting_.end(), std::greater<>());
    const auto [estimate, distance, stop] = waiting_.back();
    waiting_.pop_back();
    if (distance > reached(stop)->distance) continue;
    if (landingOf(stop)) return wayTo(stop);
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
  const auto landing = landingOf(next);
  const double rest = landing ? landings_[*landing].onward : (there - goal_).norm();
  waiting_.emplace_back(distance + step + rest, distance + step, next);
  std::push_heap(waiting_.begin(), waiting_.end(), std::greater<>());
}

/// From a corner of the triangle of `h`, the one that h leaves, to what is opposite, and along its sides
/// there.
void PathSearch::offer(std::optional<Stop> before, double distance, const Eigen::Vector3d& here,
                       HalfedgeHandle h) {
  const HalfedgeHandle far = mesh_.next_halfedge_handle(h), back = mesh_.next_halfedge_handle(far);
  if (!occupied_.edge[mesh_.edge_handle(far).idx()]) relax(before, distance, here, stopAt(far));
  if (!occupied_.edge[mesh_.edge_handle(h).idx()]) offerVertex(before, distance, here, far);
  if (!occupied_.edge[mesh_.edge_handle(back).idx()]) offerVertex(before, distance, here, back);
}

/// The corner of a triangle that `h` leaves.
void PathSearch::offerVertex(std::optional<Stop> before, double distance, const Eigen::Vector3d& here,
                             HalfedgeHandle h) {
  const VertexHandle v = mesh_.from_vertex_handle(h);
  if (!occupied_.vertex[v.idx()] || landingAt(h)) relax(before, distance, here, stopAt(v));
}

/// From the start, which `h` leaves, to a landing in the same triangle where the edge between them is taken.
void PathSearch::offerThroughTriangle(HalfedgeHandle h) {
  const HalfedgeHandle far = mesh_.next_halfedge_handle(h), back = mesh_.next_halfedge_handle(far);
  if ((occupied_.edge[mesh_.edge_handle(h).idx()] && landingAt(far)) ||
      (occupied_.edge[mesh_.edge_handle(back).idx()] && landingAt(back)))
    relax({}, 0, mesh_.point(from_), stopAt(mesh_.face_handle(h)));
}

void PathSearch::expand(const Stop& stop, double distance) {
  const Eigen::Vector3d here = place(stop);
  if (stop.kind == Stop::Vertex) {
    for (const auto h : mesh_.voh_range(VertexHandle(stop.index))) offer(stop, distance, here, h);
  } else if (stop.kind == Stop::Side) {
    const HalfedgeHandle next = mesh_.next_halfedge_handle(
                             mesh_.opposite_halfedge_handle(HalfedgeHandle(stop.index))),
                         last = mesh_.next_halfedge_handle(next);
    for (const HalfedgeHandle h : {next, last})
      if (!occupied_.edge[mesh_.edge_handle(h).idx()]) relax(stop, distance, here, stopAt(h));
    offerVertex(stop, distance, here, last);
  } else {
    for (const auto h : mesh_.fh_range(FaceHandle(stop.index)))
      if (landingAt(h)) relax(stop, distance, here, stopAt(mesh_.from_vertex_handle(h)));
  }
}

/// The landing that has the corner of a triangle that `h` leaves.
std::optional<std::size_t> PathSearch::landingAt(HalfedgeHandle h) const {
  const auto landing = landingOf(stopAt(mesh_.from_vertex_handle(h)));
  if (!landing) return {};
  const PatchCorner& corner = landings_[*landing].corner;
  for (HalfedgeHandle out = corner.out; out != h;) {
    const HalfedgeHandle back = mesh_.prev_halfedge_handle(out);
    if (back == corner.in) return {};
    out = mesh_.opposite_halfedge_handle(back);
  }
  return landing;
}

/// (Numbers of earlier searches do not match.)
std::optional<std::size_t> PathSearch::landingOf(const Stop& stop) const {
  if (stop.kind != Stop::Vertex) return {};
  const std::size_t number = landingNumbers_[std::size_t(stop.index)];
  if (number >= landings_.size() ||
      mesh_.from_vertex_handle(landings_[number].corner.out).idx() != stop.index)
    return {};
  return number;
}

/// What is known of the stop, if it was reached. (Numbers of earlier searches do not match.)
PathSearch::Reached* PathSearch::reached(const Stop& stop) {
  const auto number = std::size_t(numbers_[stop.kind][std::size_t(stop.index)]);
  return number < reached_.size() && reached_[number].stop == stop ? &reached_[number] : nullptr;
}

std::vector<PathSearch::Stop> PathSearch::wayTo(const Stop& stop) {
  std::vector<Stop> stops;
  for (std::optional<Stop> at = stop; at; at = reached(*at)->before) stops.push_back(*at);
  std::reverse(stops.begin(), stops.end());
  return stops;
}

}  // namespace trimquad
