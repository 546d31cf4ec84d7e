#include "trimquad/spline/chart.h"

#include <Eigen/Geometry>

#include <cmath>
#include <deque>
#include <limits>
#include <numeric>
#include <string>

#include "trimquad/base/error.h"
#include "trimquad/mesh/boundary_image.h"

namespace trimquad {
namespace {

Error unchartable(const std::string& what, const Parametrization& map, HalfedgeHandle h) {
  return stageError("fit", what + "; cut the region there, or use a smaller feature angle",
                    "edge " + std::to_string(h.idx() / 2), map.mesh.point(map.mesh.from_vertex_handle(h)));
}

/// By face: the change from the chart that the face has in the map to the one plane, by breadth-first search.
std::vector<Transition> unroll(const Parametrization& map) {
  const auto& mesh = map.mesh;
  std::vector<Transition> toPlane(mesh.n_faces());
  std::vector<char> reached(mesh.n_faces(), 0);
  std::deque<FaceHandle> queue{FaceHandle(0)};
  reached[0] = 1;
  size_t count = 1;
  for (; !queue.empty(); queue.pop_front()) {
    const FaceHandle f = queue.front();
    for (const auto h : mesh.fh_range(f)) {
      const FaceHandle g = mesh.face_handle(mesh.opposite_halfedge_handle(h));
      if (!g.is_valid() || reached[g.idx()]) continue;
      toPlane[g.idx()] = toPlane[f.idx()].after(map.transition(h).inverse());
      reached[g.idx()] = 1;
      ++count;
      queue.push_back(g);
    }
  }
  if (count != mesh.n_faces())
    throw stageError("fit", "the region falls into pieces that do not hang together");
  return toPlane;
}

/// The one translation, along one axis, that all transitions left after unrolling are multiples of; none
/// where all are the identity.
std::optional<FixedVector> periodOf(const Parametrization& map, const std::vector<Transition>& toPlane) {
  const auto& mesh = map.mesh;
  Quanta period[2] = {0, 0};
  for (const auto e : mesh.edges()) {
    if (mesh.is_boundary(e)) continue;
    const HalfedgeHandle h = mesh.halfedge_handle(e, 0);
    const auto& f = toPlane[mesh.face_handle(h).idx()];
    const auto& g = toPlane[mesh.face_handle(mesh.opposite_halfedge_handle(h)).idx()];
    const Transition left = g.after(map.transition(h)).after(f.inverse());
    if (left.isIdentity()) continue;
    if (left.rotation != 0)
      throw unchartable("the map has a singularity, so one surface cannot hold the region", map, h);
    const FixedVector t = left.translation;
    if (t.u != 0 && t.v != 0)
      throw unchartable("the map closes obliquely to the grid, so one surface cannot hold the region", map,
                        h);
    period[0] = std::gcd(period[0], t.u);
    period[1] = std::gcd(period[1], t.v);
    if (period[0] != 0 && period[1] != 0)
      throw unchartable("the region closes in both directions, so one surface cannot hold it", map, h);
  }
  if (period[0] == 0 && period[1] == 0) return {};
  return FixedVector{period[0], period[1]};
}

/// Throws unless the map is one to one. It is locally, so every point of the plane has as many images back as
/// the boundary winds around it: at most one exactly if the boundary's image consists of disjoint simple
/// loops, one of which goes around the region counter-clockwise (on a tube: one around it each way), the
/// others clockwise.
void requireInjective(const Parametrization& map, const Chart& chart) {
  const auto& mesh = map.mesh;
  std::vector<BoundarySegment> segments;
  std::vector<HalfedgeHandle> inner;
  int outer = 0, forward = 0, backward = 0;
  HalfedgeHandle wrong;
  for (const auto& loop : boundaryLoops(mesh)) {
    const int base = int(segments.size()), size = int(loop.size());
    FixedVector position;
    WideQuanta doubleArea = 0;
    for (int i = 0; i < size; ++i) {
      // The region lies to the left of the inner halfedges, which follow each other against the loop.
      const HalfedgeHandle h = mesh.opposite_halfedge_handle(loop[size - 1 - i]);
      const FixedVector from = chart.corner[h.idx()], to = chart.corner[mesh.next_halfedge_handle(h).idx()];
      segments.push_back({from, to, base + (i + 1) % size});
      inner.push_back(h);
      const FixedVector next = position + (to - from);
      doubleArea += cross(position, next);
      position = next;
    }
    if (position == FixedVector{}) {
      if (doubleArea > 0) ++outer;
    } else if (chart.period && position == FixedVector{*chart.period, 0}) {
      ++forward;
    } else if (chart.period && position == FixedVector{-*chart.period, 0}) {
      ++backward;
    } else {
      wrong = inner.back();
    }
  }
  const std::string twice = "the map covers a part of the plane twice, so one surface cannot hold the region";
  if (wrong.is_valid()) throw unchartable(twice, map, wrong);
  if (chart.period ? outer != 0 || forward != 1 || backward != 1 : outer != 1)
    throw unchartable(twice, map, inner.empty() ? mesh.halfedge_handle(FaceHandle(0)) : inner.front());
  if (const auto contact = firstContact(segments, chart.period))
    throw unchartable(twice, map, inner[contact->first]);
}

}  // namespace

Chart chart(const GridMap& map) {
  const auto& mesh = map.mesh;
  if (mesh.n_faces() == 0) throw stageError("fit", "the region has no triangles");
  const auto toPlane = unroll(map);
  const auto period = periodOf(map, toPlane);
  const int turn = period && period->v != 0 ? 1 : 0;  // a period in v becomes one in u
  Chart chart{map.scale, std::vector<FixedVector>(mesh.n_halfedges()), {}};
  if (period) chart.period = turn ? period->v : period->u;
  if (period && !map.scale.isInteger(*chart.period))
    throw stageError("fit", "the map closes after a fraction of a quad; only grid maps can be fitted");
  constexpr Quanta largest = Quanta(1) << 50;  // sums and products of differences stay exact
  for (const auto f : mesh.faces())
    for (const auto h : mesh.fh_range(f)) {
      const FixedVector x = rotated(toPlane[f.idx()](map.from(h)), turn);
      if (std::abs(x.u) >= largest || std::abs(x.v) >= largest)
        throw unchartable("the unrolled map is too long for exact coordinates", map, h);
      chart.corner[h.idx()] = x;
    }
  requireInjective(map, chart);
  return chart;
}

std::optional<Chart> singleChart(const GridMap& map) {
  try {
    return chart(map);
  } catch (const Error& error) {
    if (error.kind() != Error::Kind::Stage) throw;
    return {};
  }
}

Chart turnedToSmallestRectangle(const Chart& chart, const SurfaceMesh& mesh) {
  TRIMQUAD_ASSERT(!chart.period);
  std::vector<Eigen::Vector2d> outline;
  for (const auto h : mesh.halfedges())
    if (mesh.is_boundary(mesh.opposite_halfedge_handle(h)))
      outline.push_back(chart.scale.toQuads(chart.corner[h.idx()]));
  const auto turn = [](int degrees) { return Eigen::Rotation2Dd(degrees * M_PI / 180).toRotationMatrix(); };
  int best = 0;
  double smallest = std::numeric_limits<double>::infinity();
  for (int degrees = 0; degrees < 90; ++degrees) {
    Eigen::AlignedBox2d box;
    for (const auto& x : outline) box.extend(turn(degrees) * x);
    if (box.volume() < smallest) {
      smallest = box.volume();
      best = degrees;
    }
  }
  Chart result = chart;
  const Eigen::Matrix2d matrix = turn(best);
  for (auto& x : result.corner) {
    const Eigen::Vector2d y = matrix * Eigen::Vector2d(double(x.u), double(x.v));
    x = {std::llround(y[0]), std::llround(y[1])};
  }
  return result;
}

}  // namespace trimquad
