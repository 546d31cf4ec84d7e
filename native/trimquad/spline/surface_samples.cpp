#include "trimquad/spline/surface_samples.h"

#include <algorithm>
#include <cmath>

namespace trimquad {
namespace {

constexpr double kSamplesAcrossSpan = 4;
constexpr int kLargestOrder = 16;
/// Width of the strip along the boundary whose weight the boundary's samples carry in addition, quads.
constexpr double kBoundaryStrip = 0.25;

int latticeSize(int order) {
  return order * (order + 1) / 2;
}

}  // namespace

SurfaceSamples::SurfaceSamples(const Region& region, const GridMap& map, const Chart& chart, double seam,
                               const Progress& progress)
    : region_(region), mesh_(map.mesh), chart_(chart), seam_(seam) {
  if (chart.period) period_ = chart.scale.toQuads(*chart.period);
  std::vector<double> extents;
  std::vector<Eigen::Vector3d> normals(mesh_.n_vertices(), Eigen::Vector3d::Zero());
  samples.resize(mesh_.n_vertices());
  for (const auto f : mesh_.faces()) {
    const HalfedgeHandle h = mesh_.halfedge_handle(f);
    const Corners c = chartCorners(h);
    const Eigen::Vector2d a = c[1] - c[0], b = c[2] - c[0];
    const double area = 0.5 * (a.x() * b.y() - a.y() * b.x());
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
      samples[v].parameter = wrapped(c[k]);
    }
  }
  std::nth_element(extents.begin(), extents.begin() + extents.size() / 2, extents.end());
  extent_ = extents[extents.size() / 2];
  for (const auto v : mesh_.vertices()) {
    if (v.idx() % 1024 == 0) progress.check();
    auto& s = samples[v.idx()];
    s.point = mesh_.point(v);
    s.normal = normals[v.idx()].normalized();
    if (!region.surface) continue;
    const auto foot = region.surface->closestFacing(s.point, s.normal);
    s.normal = foot.normal;
    // Boundary vertices stay on the curve that the neighbouring region shares.
    if (!mesh_.is_boundary(v)) s.point = foot.point;
  }
  for (const auto h : mesh_.halfedges())
    if (mesh_.is_boundary(h)) boundary_.push_back(mesh_.opposite_halfedge_handle(h));
  for (const auto& s : samples) chartParameter_.push_back(s.parameter);
  order_.assign(mesh_.n_faces(), 0);
  controlOrder_ = order_;
  firstOfFace_ = order_;
  firstOfBoundary_.assign(boundary_.size(), 0);
}

Eigen::Vector2d SurfaceSamples::wrapped(Eigen::Vector2d x) const {
  if (period_ > 0) x[0] -= period_ * std::floor((x[0] - seam_) / period_);
  return x;
}

Eigen::Vector2d SurfaceSamples::difference(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const {
  Eigen::Vector2d d = to - from;
  if (period_ > 0) d[0] -= period_ * std::round(d[0] / period_);
  return d;
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
  s.normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]).normalized();
  if (region_.surface) {
    const auto foot = region_.surface->closestFacing(s.point, s.normal);
    s.point = foot.point;
    s.normal = foot.normal;
  }
  return s;
}

int SurfaceSamples::latticeOrder(FaceHandle f, const SplineSpace& space) const {
  const HalfedgeHandle h = mesh_.halfedge_handle(f);
  const Corners c = chartCorners(h);
  const Eigen::Vector2d start = samples[mesh_.from_vertex_handle(h).idx()].parameter - c[0];
  double order = 1;
  for (int axis = 0; axis < 2; ++axis) {
    const SplineLine& line = axis == 0 ? space.u : space.v;
    const auto [low, high] = std::minmax({c[0][axis], c[1][axis], c[2][axis]});
    double narrowest = line.width(line.spanOf(start[axis] + low));
    for (int i = line.spanOf(start[axis] + low); i <= line.spanOf(start[axis] + high); ++i)
      narrowest = std::min(narrowest, line.width(i));
    order = std::max(order, std::ceil(kSamplesAcrossSpan * (high - low) / narrowest));
  }
  return int(std::min<double>(order, kLargestOrder));
}

void SurfaceSamples::appendFace(FaceHandle f, int order, std::vector<SurfaceSample>& to) const {
  const HalfedgeHandle h = mesh_.halfedge_handle(f);
  for (int i = 0; i < order; ++i)
    for (int j = 0; i + j < order; ++j) {
      const double x = (i + 1. / 3) / order, y = (j + 1. / 3) / order;
      to.push_back(sample(h, {1 - x - y, x, y}));
    }
}

void SurfaceSamples::appendBoundary(HalfedgeHandle inner, int order, std::vector<SurfaceSample>& to) const {
  const double length = (chartCorners(inner)[1] - chartCorners(inner)[0]).norm();
  for (int i = 0; i < order; ++i) {
    const double x = (i + 0.5) / order;
    to.push_back(sample(inner, {1 - x, x, 0}));
    to.back().weight = kBoundaryStrip * length / order;
  }
}

void SurfaceSamples::refine(const SplineSpace& space, const Progress& progress) {
  const int vertices = int(mesh_.n_vertices());
  const bool first = cells_.empty();
  std::vector<SurfaceSample> old = samples;
  std::vector<int> order(order_.size());
  for (const auto f : mesh_.faces()) order[f.idx()] = std::max(order_[f.idx()], latticeOrder(f, space));
  if (!first && order == order_) return;
  samples.resize(vertices);
  cells_.clear();
  std::vector<SurfaceSample> fresh;
  for (size_t b = 0; b < boundary_.size(); ++b) {
    const int f = mesh_.face_handle(boundary_[b]).idx();
    const int begin = firstOfBoundary_[b];
    firstOfBoundary_[b] = vertices + int(fresh.size());
    if (order[f] == order_[f])
      fresh.insert(fresh.end(), old.begin() + begin, old.begin() + begin + order[f]);
    else
      appendBoundary(boundary_[b], order[f], fresh);
  }
  for (int v = 0; v < vertices; ++v) samples[v].weight = 0;
  for (const auto f : mesh_.faces()) {
    if (f.idx() % 256 == 0) progress.check();
    const int q = order[f.idx()], begin = firstOfFace_[f.idx()], inside = q > 1 ? latticeSize(q) : 0;
    const int now = vertices + int(fresh.size());
    if (q > 1 && q == order_[f.idx()])
      fresh.insert(fresh.end(), old.begin() + begin, old.begin() + begin + inside);
    else if (q > 1)
      appendFace(f, q, fresh);
    firstOfFace_[f.idx()] = now;
    const HalfedgeHandle h = mesh_.halfedge_handle(f);
    const Corners c = chartCorners(h);
    const Eigen::Vector2d a = c[1] - c[0], b = c[2] - c[0];
    const double weight = 0.5 * (a.x() * b.y() - a.y() * b.x()) / (3 + inside);
    std::array<int, 3> corner;
    HalfedgeHandle at = h;
    for (auto& k : corner) {
      k = mesh_.from_vertex_handle(at).idx();
      samples[k].weight += weight;
      at = mesh_.next_halfedge_handle(at);
    }
    for (int k = 0; k < inside; ++k) fresh[now - vertices + k].weight = weight;
    if (inside == 0) cells_.push_back(corner);
    for (int i = 0, row = now; i < q && inside; row += q - i, ++i)
      for (int j = 0; i + j + 1 < q; ++j) cells_.push_back({row + j, row + q - i + j, row + j + 1});
  }
  samples.insert(samples.end(), fresh.begin(), fresh.end());
  chartParameter_.resize(vertices);
  for (const auto& s : fresh) chartParameter_.push_back(s.parameter);
  order_ = std::move(order);
}

const std::vector<SurfaceSample>& SurfaceSamples::control(const SplineSpace& space,
                                                          const Progress& progress) {
  std::vector<int> order(order_.size());
  for (const auto f : mesh_.faces())
    order[f.idx()] = std::max(controlOrder_[f.idx()], latticeOrder(f, space) + 1);
  if (order == controlOrder_) return control_;
  control_.clear();
  for (const auto f : mesh_.faces()) {
    if (f.idx() % 256 == 0) progress.check();
    appendFace(f, order[f.idx()], control_);
  }
  for (const auto h : boundary_) appendBoundary(h, order[mesh_.face_handle(h).idx()], control_);
  controlOrder_ = std::move(order);
  return control_;
}

}  // namespace trimquad
