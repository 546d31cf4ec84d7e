#include "trimquad/brep/face_separation.h"

#include <algorithm>
#include <limits>
#include <optional>

namespace trimquad {
namespace {

/// Distance from their plane within which the poles of a flat surface are, model units: OpenCASCADE's own
/// tolerance for points.
constexpr double kFlat = 1e-7;
/// Distances that are certain, in tolerances.
constexpr double kSure = 10;

using Plane = Eigen::Hyperplane<double, 3>;

std::optional<Plane> planeOf(const SplineSurface& surface) {
  const int i = surface.countU - 1, j = surface.countV - 1;
  const Eigen::Vector3d across = surface.pole(i, j) - surface.pole(0, 0),
                        back = surface.pole(0, j) - surface.pole(i, 0), normal = across.cross(back);
  if (!(normal.norm() > 0)) return std::nullopt;
  const Plane plane(normal.normalized(), surface.pole(0, 0));
  for (const auto& pole : surface.poles)
    if (!(plane.absDistance(pole) <= kFlat)) return std::nullopt;
  return plane;
}

/// The values of a coordinate.
struct Range {
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;

  void add(double x) {
    lowest = std::min(lowest, x);
    highest = std::max(highest, x);
  }
  /// There are some, all below or all above [from, to] by more than `distance`.
  bool isBeyond(double from, double to, double distance) const {
    return lowest <= highest && (lowest > to + distance || highest < from - distance);
  }
};

bool areApart(const Eigen::AlignedBox3d& a, const Eigen::AlignedBox3d& b, double distance) {
  return a.squaredExteriorDistance(b) > distance * distance;
}

bool areApart(const std::vector<FaceCell>& a, const FaceCell& b, double distance) {
  return std::all_of(a.begin(), a.end(),
                     [&](const FaceCell& cell) { return areApart(cell.box, b.box, distance); });
}

}  // namespace

FaceSeparation::FaceSeparation(const SplineModel& model) : model_(model) {
  for (const auto& face : model.faces) {
    Face& found = faces_.emplace_back();
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
    if (const auto plane = planeOf(face.surface)) {
      Flat flat{.plane = *plane, .axes = {}, .rectangle = {}};
      const Eigen::Vector3d along =
          (face.surface.pole(face.surface.countU - 1, 0) - face.surface.pole(0, 0)).normalized();
      flat.axes << along.transpose(), plane->normal().cross(along).transpose();
      for (const auto e : found.edges)
        for (const auto& pole : model.edges[e.index].curve.poles) {
          found.box.extend(pole);
          flat.rectangle.extend(flat.axes * pole);
        }
      found.shape = flat;
    } else {
      auto cells = faceCells(face);
      for (const auto& cell : cells) found.box.extend(cell.box);
      found.shape = std::move(cells);
    }
  }
}

bool FaceSeparation::areApart(int a, int b) const {
  const Face *one = &faces_.at(a), *other = &faces_.at(b);
  const double distance = kSure * (one->tolerance + other->tolerance);
  if (trimquad::areApart(one->box, other->box, distance)) return true;
  if (one->shape.index() > other->shape.index()) std::swap(one, other);
  if (const auto* flat = std::get_if<Flat>(&one->shape)) {
    if (const auto* second = std::get_if<Flat>(&other->shape))
      return isBeside(*other, *one, *flat, distance) || isBeside(*one, *other, *second, distance);
  }
  if (std::any_of(one->vertices.begin(), one->vertices.end(),
                  [&](SplineVertexId v) { return other->vertices.contains(v); }))
    return false;
  const auto& cells = std::get<1>(other->shape);
  return std::all_of(cells.begin(), cells.end(), [&](const FaceCell& cell) {
    if (trimquad::areApart(cell.box, one->box, distance)) return true;
    const auto* flat = std::get_if<Flat>(&one->shape);
    if (!flat) return trimquad::areApart(std::get<1>(one->shape), cell, distance);
    Range height, x, y;
    for (const auto& point : cell.points) {
      const Eigen::Vector2d foot = flat->axes * point;
      height.add(flat->plane.signedDistance(point));
      x.add(foot[0]);
      y.add(foot[1]);
    }
    const auto &low = flat->rectangle.min(), &high = flat->rectangle.max();
    return height.isBeyond(0, 0, distance) || x.isBeyond(low[0], high[0], distance) ||
           y.isBeyond(low[1], high[1], distance);
  });
}

/// Of two flat faces: `face` is inside the hull of its edges. Where no corner of the hull but shared ones
/// touches the plane, nothing else does.
bool FaceSeparation::isBeside(const Face& face, const Face& other, const Flat& flat, double distance) const {
  Range height;
  const auto shares = [&](SplineVertexId v) { return other.vertices.contains(v); };
  for (const auto e : face.edges) {
    if (other.edges.contains(e)) continue;
    const auto& edge = model_.edges[e.index];
    const auto& poles = edge.curve.poles;
    for (std::size_t k = shares(edge.start); k < poles.size() - shares(edge.end); ++k)
      height.add(flat.plane.signedDistance(poles[k]));
  }
  return height.isBeyond(0, 0, distance);
}

}  // namespace trimquad
