#include "trimquad/brep/face_separation.h"

#include <algorithm>

namespace trimquad {
namespace {

/// Distance from their plane within which the poles of a flat surface are, model units: OpenCASCADE's own
/// tolerance for points.
constexpr double kFlat = 1e-7;
/// Distances to a plane that are certain, in tolerances.
constexpr double kSure = 10;

std::optional<Eigen::Hyperplane<double, 3>> planeOf(const SplineSurface& surface) {
  const int i = surface.countU - 1, j = surface.countV - 1;
  const Eigen::Vector3d across = surface.pole(i, j) - surface.pole(0, 0),
                        back = surface.pole(0, j) - surface.pole(i, 0), normal = across.cross(back);
  if (!(normal.norm() > 0)) return std::nullopt;
  const Eigen::Hyperplane<double, 3> plane(normal.normalized(), surface.pole(0, 0));
  for (const auto& pole : surface.poles)
    if (!(plane.absDistance(pole) <= kFlat)) return std::nullopt;
  return plane;
}

/// On which sides of a plane points are.
struct Sides {
  const Eigen::Hyperplane<double, 3>& plane;
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;

  void add(const Eigen::Vector3d& x) {
    const double d = plane.signedDistance(x);
    lowest = std::min(lowest, d);
    highest = std::max(highest, d);
  }
  /// Points there are, all on one side and further than `distance` from the plane.
  bool areBeyond(double distance) const {
    return lowest <= highest && (lowest > distance || highest < -distance);
  }
};

}  // namespace

FaceSeparation::FaceSeparation(const SplineModel& model) : model_(model) {
  for (const auto& face : model.faces) {
    Face& found = faces_.emplace_back();
    found.plane = planeOf(face.surface);
    found.tolerance = kFlat;
    for (const auto& loop : face.loops)
      for (const auto& coedge : loop) {
        const auto& edge = model.edges[coedge.edge.index];
        found.edges.insert(coedge.edge);
        found.tolerance = std::max(found.tolerance, edge.tolerance);
        for (const auto vertex : {edge.start, edge.end}) {
          found.vertices.insert(vertex);
          found.tolerance = std::max(found.tolerance, model.vertices[vertex.index].tolerance);
        }
      }
  }
}

bool FaceSeparation::isBeside(int face, int flat) const {
  const Face &beside = faces_.at(face), &other = faces_.at(flat);
  if (!other.plane) return false;
  Sides sides{*other.plane};
  const auto shares = [&](SplineVertexId v) { return other.vertices.contains(v); };
  if (beside.plane) {
    // Inside the hull of its edges: where no end of the hull but shared ones touches the plane, nothing does.
    for (const auto e : beside.edges) {
      if (other.edges.contains(e)) continue;
      const auto& edge = model_.edges[e.index];
      const auto& poles = edge.curve.poles;
      for (std::size_t k = shares(edge.start); k < poles.size() - shares(edge.end); ++k) sides.add(poles[k]);
    }
  } else {
    if (std::any_of(beside.vertices.begin(), beside.vertices.end(), shares)) return false;
    for (const auto& pole : model_.faces[face].surface.poles) sides.add(pole);
  }
  return sides.areBeyond(kSure * (beside.tolerance + other.tolerance));
}

}  // namespace trimquad
