#include "trimquad/spline/layout_samples.h"

#include <algorithm>
#include <cmath>

namespace trimquad {
namespace {

constexpr double kSamplesAcrossSpan = 4;
constexpr int kLargestOrder = 16;
/// Width of the strip along the boundary whose weight the boundary's samples carry in addition, quads.
constexpr double kBoundaryStrip = 0.25;

}  // namespace

LayoutSamples::LayoutSamples(const Region& region, const GridMap& map, const Layout& layout,
                             const Progress& progress)
    : region_(region), map_(map), layout_(layout), order_(map.mesh.n_faces(), 1) {
  const auto& mesh = map.mesh;
  std::vector<double> extents;
  vertexNormal_.assign(mesh.n_vertices(), Eigen::Vector3d::Zero());
  for (const auto f : mesh.faces()) {
    const Corners c = corners(f);
    const Eigen::Vector2d a = c[1] - c[0], b = c[2] - c[0];
    const double area = 0.5 * (a.x() * b.y() - a.y() * b.x());
    area_ += area;
    extents.push_back(std::sqrt(2 * area));
    std::array<Eigen::Vector3d, 3> p;
    HalfedgeHandle h = mesh.halfedge_handle(f);
    for (auto& corner : p) {
      corner = mesh.point(mesh.from_vertex_handle(h));
      h = mesh.next_halfedge_handle(h);
    }
    for (const auto v : mesh.fv_range(f)) vertexNormal_[v.idx()] += (p[1] - p[0]).cross(p[2] - p[0]);
  }
  std::nth_element(extents.begin(), extents.begin() + extents.size() / 2, extents.end());
  extent_ = extents[extents.size() / 2];
  for (const auto v : mesh.vertices()) {
    if (v.idx() % 1024 == 0) progress.check();
    vertexPoint_.push_back(mesh.point(v));
    vertexNormal_[v.idx()].normalize();
    if (!region.surface) continue;
    const auto foot = region.surface->closestFacing(mesh.point(v), vertexNormal_[v.idx()]);
    vertexNormal_[v.idx()] = foot.normal;
    // Boundary vertices stay on the curve that the neighbouring region shares.
    if (!mesh.is_boundary(v)) vertexPoint_.back() = foot.point;
  }
}

LayoutSamples::Corners LayoutSamples::corners(FaceHandle f) const {
  Corners result;
  HalfedgeHandle h = map_.mesh.halfedge_handle(f);
  for (auto& c : result) {
    c = map_.scale.toQuads(map_.from(h));
    h = map_.mesh.next_halfedge_handle(h);
  }
  return result;
}

int LayoutSamples::latticeOrder(FaceHandle f, const JoinedSpace& space) const {
  const Corners c = corners(f);
  double order = 1;
  // Knot intervals in the charts of all pieces of the triangle.
  for (const auto& piece : layout_.pieces[f.idx()]) {
    Corners x;
    for (int k = 0; k < 3; ++k) x[k] = Layout::apply(piece.toChart, layout_.scale, c[k]);
    for (int axis = 0; axis < 2; ++axis) {
      const SplineLine& line = axis == 0 ? space.charts[piece.chart].u : space.charts[piece.chart].v;
      const auto [low, high] = std::minmax({x[0][axis], x[1][axis], x[2][axis]});
      double narrowest = line.width(line.spanOf(low));
      for (int i = line.spanOf(low); i <= line.spanOf(high); ++i)
        narrowest = std::min(narrowest, line.width(i));
      order = std::max(order, std::ceil(kSamplesAcrossSpan * (high - low) / narrowest));
    }
  }
  return int(std::min<double>(order, kLargestOrder));
}

LayoutSample LayoutSamples::sample(FaceHandle f, const Eigen::Vector3d& barycentric) const {
  const auto& mesh = map_.mesh;
  const Corners c = corners(f);
  LayoutSample s;
  s.point.setZero();
  Eigen::Vector2d x = Eigen::Vector2d::Zero();
  std::array<Eigen::Vector3d, 3> p;
  HalfedgeHandle h = mesh.halfedge_handle(f);
  std::optional<VertexHandle> vertex;
  for (int k = 0; k < 3; ++k) {
    if (barycentric[k] == 1) vertex = mesh.from_vertex_handle(h);
    p[k] = mesh.point(mesh.from_vertex_handle(h));
    s.point += barycentric[k] * p[k];
    x += barycentric[k] * c[k];
    h = mesh.next_halfedge_handle(h);
  }
  const auto& piece = layout_.pieceAt(f, x);
  s.chart = piece.chart;
  s.parameter = Layout::apply(piece.toChart, layout_.scale, x);
  if (vertex) {
    s.point = vertexPoint_[vertex->idx()];
    s.normal = vertexNormal_[vertex->idx()];
    return s;
  }
  s.normal = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
  if (region_.surface) {
    const auto foot = region_.surface->closestFacing(s.point, s.normal);
    s.point = foot.point;
    s.normal = foot.normal;
  }
  return s;
}

std::vector<LayoutSample> LayoutSamples::make(const JoinedSpace& space, bool control,
                                              const Progress& progress) {
  const auto& mesh = map_.mesh;
  std::vector<LayoutSample> samples;
  cells_.clear();
  if (!control) {
    samples.resize(mesh.n_vertices());
    for (const auto v : mesh.vertices())
      for (const auto h : mesh.voh_range(v))
        if (!mesh.is_boundary(h)) {
          const auto f = mesh.face_handle(h);
          Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();
          HalfedgeHandle at = mesh.halfedge_handle(f);
          for (int k = 0; k < 3; ++k, at = mesh.next_halfedge_handle(at)) barycentric[k] = at == h;
          samples[v.idx()] = sample(f, barycentric);
          break;
        }
  }
  for (const auto f : mesh.faces()) {
    if (f.idx() % 256 == 0) progress.check();
    int& kept = order_[f.idx()];
    if (!control) kept = std::max(kept, latticeOrder(f, space));
    const int q = control ? kept + 1 : kept, first = int(samples.size());
    for (int i = 0; i < q && (q > 1 || control); ++i)
      for (int j = 0; i + j < q; ++j) {
        const double x = (i + 1. / 3) / q, y = (j + 1. / 3) / q;
        samples.push_back(sample(f, {1 - x - y, x, y}));
      }
    const Corners c = corners(f);
    const Eigen::Vector2d a = c[1] - c[0], b = c[2] - c[0];
    const int inside = int(samples.size()) - first;
    const double weight = 0.5 * (a.x() * b.y() - a.y() * b.x()) / (inside + (control ? 0 : 3));
    for (int k = 0; k < inside; ++k) samples[first + k].weight = weight;
    HalfedgeHandle h = mesh.halfedge_handle(f);
    std::array<int, 3> vertices;
    for (int k = 0; k < 3; ++k, h = mesh.next_halfedge_handle(h)) {
      vertices[k] = mesh.from_vertex_handle(h).idx();
      if (!control) samples[vertices[k]].weight += weight;
      const HalfedgeHandle outside = mesh.opposite_halfedge_handle(h);
      if (!mesh.is_boundary(outside)) continue;
      for (int i = 0; i < q; ++i) {
        Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();
        barycentric[(k + 1) % 3] = (i + 0.5) / q;
        barycentric[k] = 1 - barycentric[(k + 1) % 3];
        samples.push_back(sample(f, barycentric));
        samples.back().weight = kBoundaryStrip * (c[(k + 1) % 3] - c[k]).norm() / q;
      }
    }
    const auto addCell = [&](int i, int j, int k) {
      if (samples[i].chart == samples[j].chart && samples[j].chart == samples[k].chart)
        cells_.push_back({i, j, k});
    };
    if (control) continue;
    for (int i = 0, row = first; i < q && inside; row += q - i, ++i)
      for (int j = 0; i + j + 1 < q; ++j) addCell(row + j, row + q - i + j, row + j + 1);
    if (inside == 0 && samples[vertices[0]].chart == samples[vertices[1]].chart) {
      // Vertices may have their parameters from the chart of another triangle.
      const auto &p = samples[vertices[0]].parameter, &r = samples[vertices[1]].parameter,
                 &t = samples[vertices[2]].parameter;
      const double turn = (r - p)[0] * (t - p)[1] - (r - p)[1] * (t - p)[0];
      if (turn > 0 && std::abs(turn - (a.x() * b.y() - a.y() * b.x())) < 1e-6)
        addCell(vertices[0], vertices[1], vertices[2]);
    }
  }
  return samples;
}

}  // namespace trimquad
