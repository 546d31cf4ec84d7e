#include "trimquad/spline/surface_samples.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "trimquad/base/parallel.h"
#include "trimquad/spline/knot_lattice.h"

namespace trimquad {

void moveOntoTrueSurface(const Region& region, const std::vector<int>& chosen,
                         std::vector<SurfaceSample>& samples, int threads, const Progress& progress) {
  if (!region.surface) return;
  parallelParts(int(chosen.size()), threads, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      if (i % 1024 == 0) progress.check();
      SurfaceSample& s = samples[chosen[i]];
      const auto foot = region.surface->closestFacing(s.point, s.normal);
      s.point = foot.point;
      s.normal = foot.normal;
    }
  });
}

SurfaceSamples::SurfaceSamples(const Region& region, const GridMap& map, const Chart& chart, double seam,
                               const Progress& progress)
    : region_(region), mesh_(map.mesh), chart_(chart), seam_(seam) {
  if (chart.period) period_ = chart.scale.toQuads(*chart.period);
  std::vector<double> extents;
  std::vector<Eigen::Vector3d> normals(mesh_.n_vertices(), Eigen::Vector3d::Zero());
  vertices_.resize(mesh_.n_vertices());
  for (const auto f : mesh_.faces()) {
    const HalfedgeHandle h = mesh_.halfedge_handle(f);
    const Corners c = chartCorners(h);
    const double area = areaOf(f);
    chartArea_ += area;
    extents.push_back(std::sqrt(2 * area));
    Eigen::Vector3d corner[3];
    HalfedgeHandle at = h;
    for (auto& p : corner) {
      p = mesh_.point(mesh_.from_vertex_handle(at));
      at = mesh_.next_halfedge_handle(at);
    }
    for (int k = 0; k < 3; ++k, at = mesh_.next_halfedge_handle(at)) {
      const int v = mesh_.from_vertex_handle(at).idx();
      normals[v] += (corner[1] - corner[0]).cross(corner[2] - corner[0]);
      vertices_[v].parameter = wrapped(c[k]);
      vertices_[v].weight += kVertexShare * area / 3;
    }
  }
  const std::size_t small = extents.size() / kSmallTriangles;
  std::nth_element(extents.begin(), extents.begin() + small, extents.end());
  extent_ = extents[small];
  for (const auto v : mesh_.vertices()) {
    if (v.idx() % 1024 == 0) progress.check();
    auto& s = vertices_[v.idx()];
    s.point = mesh_.point(v);
    s.normal = s.meshNormal = normals[v.idx()].normalized();
    if (!region.surface) continue;
    const auto foot = region.surface->closestFacing(s.point, s.normal);
    s.normal = foot.normal;
    // Boundary vertices stay on the curve that the neighbouring region shares.
    if (!mesh_.is_boundary(v)) s.point = foot.point;
  }
  for (const auto h : mesh_.halfedges())
    if (mesh_.is_boundary(h)) boundary_.push_back(mesh_.opposite_halfedge_handle(h));
}

Eigen::Vector2d SurfaceSamples::wrapped(Eigen::Vector2d x) const {
  if (period_ > 0) x[0] -= period_ * std::floor((x[0] - seam_) / period_);
  return x;
}

SurfaceSamples::Corners SurfaceSamples::chartCorners(HalfedgeHandle h) const {
  Corners corners;
  for (auto& c : corners) {
    c = chart_.scale.toQuads(chart_.corner[h.idx()]);
    h = mesh_.next_halfedge_handle(h);
  }
  return corners;
}

SurfaceSample SurfaceSamples::sample(HalfedgeHandle h, const Eigen::Vector3d& barycentric) const {
  const Corners chart = chartCorners(h);
  SurfaceSample s;
  s.point.setZero();
  s.parameter.setZero();
  Eigen::Vector3d corner[3];
  HalfedgeHandle at = h;
  for (int k = 0; k < 3; ++k, at = mesh_.next_halfedge_handle(at)) {
    const VertexHandle v = mesh_.from_vertex_handle(at);
    corner[k] = mesh_.point(v);
    s.point += barycentric[k] * corner[k];
    s.parameter += barycentric[k] * chart[k];
  }
  s.parameter = wrapped(s.parameter);
  s.normal = s.meshNormal = (corner[1] - corner[0]).cross(corner[2] - corner[0]).normalized();
  return s;
}

double SurfaceSamples::areaOf(FaceHandle f) const {
  const Corners c = chartCorners(mesh_.halfedge_handle(f));
  const Eigen::Vector2d a = c[1] - c[0], b = c[2] - c[0];
  return 0.5 * (a.x() * b.y() - a.y() * b.x());
}

std::vector<SurfaceSample> SurfaceSamples::make(const SplineSpace& space, bool control, int threads,
                                                const Progress& progress) {
  const int across = control ? kControlsAcrossSpan : kSamplesAcrossSpan;
  std::vector<SurfaceSample> samples;
  cells_.clear();
  if (!control) samples = vertices_;
  const int first = int(samples.size());
  const KnotLattice knots(space, across);
  std::vector<std::array<int, 3>> lattice;
  for (const auto f : mesh_.faces()) {
    if (f.idx() % 256 == 0) progress.check();
    const HalfedgeHandle h = mesh_.halfedge_handle(f);
    const Corners c = chartCorners(h);
    // In a closed chart the triangle may lie a period beside the domain, or across its end.
    const double start = wrapped(c[0])[0] - c[0][0];
    for (const double shift : {start - period_, start, start + period_}) {
      if (shift != start && period_ == 0) continue;
      Corners x = c;
      for (auto& corner : x) corner[0] += shift;
      for (const auto& point : knots.in(x)) {
        samples.push_back(sample(h, point.barycentric));
        samples.back().weight = (control ? 1 : 1 - kVertexShare) * point.area;
        lattice.push_back({0, point.index[0], point.index[1]});
      }
    }
  }
  if (!control) cells_ = latticeCells(lattice, first);
  for (const auto h : boundary_) {
    const Corners c = chartCorners(h);
    const Eigen::Vector2d shift = wrapped(c[0]) - c[0];
    const int parts = latticeParts(space, c[0] + shift, c[1] + shift, across);
    for (int i = 0; i < parts; ++i) {
      const double x = (i + 0.5) / parts;
      samples.push_back(sample(h, {1 - x, x, 0}));
      samples.back().weight = kBoundaryStrip * (c[1] - c[0]).norm() / parts;
    }
  }
  std::vector<int> onTriangles(samples.size() - first);
  std::iota(onTriangles.begin(), onTriangles.end(), first);
  moveOntoTrueSurface(region_, onTriangles, samples, threads, progress);
  return samples;
}

}  // namespace trimquad
