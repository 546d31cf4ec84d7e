#include "trimquad/spline/layout_samples.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "trimquad/spline/knot_lattice.h"

namespace trimquad {
namespace {

/// How far from a singularity parameters are moved, quads.
constexpr double kSingularReach = 2;
/// How far from one the samples are denser, knot intervals.
constexpr double kFineIntervals = 2;

/// Where the direction `along` goes in the plane around a singularity, in which sectors of `exponent` quarter
/// turns each lie evenly: in terms of its sector's two sides. What is a flat surface there becomes linear.
Eigen::Vector2d flattened(const Eigen::Vector2d& along, double exponent) {
  const double sector = exponent * M_PI / 2;
  if (!(sector < M_PI)) return along;
  const double angle = exponent * std::atan2(std::abs(along[1]), std::abs(along[0]));
  return {std::copysign(std::sin(sector - angle) / std::sin(sector), along[0]),
          std::copysign(std::sin(angle) / std::sin(sector), along[1])};
}

}  // namespace

LayoutSamples::LayoutSamples(const Region& region, const GridMap& map, const Layout& layout,
                             const Progress& progress)
    : region_(region), map_(map), layout_(layout) {
  const auto& mesh = map.mesh;
  std::vector<double> extents;
  vertexNormal_.assign(mesh.n_vertices(), Eigen::Vector3d::Zero());
  for (const auto f : mesh.faces()) {
    area_ += areaOf(f);
    extents.push_back(std::sqrt(2 * areaOf(f)));
    std::array<Eigen::Vector3d, 3> p;
    HalfedgeHandle h = mesh.halfedge_handle(f);
    for (auto& corner : p) {
      corner = mesh.point(mesh.from_vertex_handle(h));
      h = mesh.next_halfedge_handle(h);
    }
    for (const auto v : mesh.fv_range(f)) vertexNormal_[v.idx()] += (p[1] - p[0]).cross(p[2] - p[0]);
  }
  bendsAt_.assign(mesh.n_edges(), false);
  for (const auto e : mesh.edges()) bendsAt_[e.idx()] = mesh.is_boundary(e);
  for (const auto e : map.aligned) bendsAt_[e.idx()] = true;
  collectSingularCorners();
  const std::size_t small = extents.size() / kSmallTriangles;
  std::nth_element(extents.begin(), extents.begin() + small, extents.end());
  extent_ = extents[small];
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

void LayoutSamples::collectSingularCorners() {
  singular_.resize(layout_.charts.size());
  std::map<int, double> reach;  // by point
  struct Corner {
    int point;
    Eigen::Vector2d at;
  };
  std::vector<std::vector<Corner>> corners(layout_.charts.size());
  for (const auto& border : layout_.borders)
    for (const bool atStart : {true, false}) {
      const int point = atStart ? border.startPoint : border.endPoint;
      if (!layout_.points[point].isSingular()) continue;
      reach[point] = kSingularReach;
      // Every sector has two borders there; one of them has it to its left, seen from the singularity.
      const int side = atStart ? 0 : 1;
      corners[border.chart[side]].push_back({point, atStart ? border.start[side] : border.end[side]});
    }
  // What is moved must end within the charts around the singularity, and before the next one's.
  for (std::size_t c = 0; c < corners.size(); ++c)
    for (const auto& a : corners[c])
      for (const auto& b : corners[c])
        if (a.at != b.at) reach[a.point] = std::min(reach[a.point], (a.at - b.at).norm() / 2);
  for (const auto& border : layout_.borders)
    for (const int side : {0, 1})
      for (const auto& corner : corners[border.chart[side]]) {
        const Eigen::Vector2d &p = border.start[side], &q = border.end[side];
        // Along a border of its own as far as that goes, away from others as far as they are.
        const double away =
            corner.at == p || corner.at == q
                ? border.length()
                : (corner.at - corner.at.cwiseMax(p.cwiseMin(q)).cwiseMin(p.cwiseMax(q))).norm();
        reach[corner.point] = std::min(reach[corner.point], away);
      }
  for (std::size_t c = 0; c < corners.size(); ++c)
    for (const auto& corner : corners[c])
      singular_[c].push_back(
          {corner.at, reach.at(corner.point), 4.0 / layout_.points[corner.point].quarters});
}

/// Whether a triangle of a chart's plane comes within a few knot intervals of a singularity.
bool LayoutSamples::isNearSingularity(int chart, const Corners& triangle, const SplineSpace& space) const {
  const Eigen::Vector2d low = triangle[0].cwiseMin(triangle[1]).cwiseMin(triangle[2]),
                        high = triangle[0].cwiseMax(triangle[1]).cwiseMax(triangle[2]);
  return std::any_of(singular_[chart].begin(), singular_[chart].end(), [&](const SingularCorner& corner) {
    const Eigen::Vector2d away = corner.at - corner.at.cwiseMax(low).cwiseMin(high);
    return std::abs(away[0]) < kFineIntervals * space.u.width(space.u.spanOf(corner.at[0])) &&
           std::abs(away[1]) < kFineIntervals * space.v.width(space.v.spanOf(corner.at[1]));
  });
}

Eigen::Vector2d LayoutSamples::regularised(int chart, const Eigen::Vector2d& x) const {
  for (const auto& corner : singular_[chart]) {
    const Eigen::Vector2d away = x - corner.at;
    const double part = away.norm() / corner.reach;
    if (!(part > 0 && part < 1)) continue;
    const double near = (1 - part) * (1 - part);
    const double length = away.norm() * std::pow(part, (corner.exponent - 1) * near);
    const Eigen::Vector2d along = away.normalized();
    const Eigen::Vector2d flat = flattens ? flattened(along, corner.exponent) : along;
    return corner.at + length * ((1 - near) * along + near * flat);
  }
  return x;
}

LayoutSamples::Corners LayoutSamples::corners(FaceHandle f, const Transition& toChart) const {
  Corners result;
  HalfedgeHandle h = map_.mesh.halfedge_handle(f);
  for (auto& c : result) {
    c = Layout::apply(toChart, layout_.scale, map_.scale.toQuads(map_.from(h)));
    h = map_.mesh.next_halfedge_handle(h);
  }
  return result;
}

Eigen::Vector2d LayoutSamples::at(FaceHandle f, const Eigen::Vector3d& barycentric) const {
  const Corners c = corners(f);
  return barycentric[0] * c[0] + barycentric[1] * c[1] + barycentric[2] * c[2];
}

double LayoutSamples::areaOf(FaceHandle f) const {
  const Corners c = corners(f);
  const Eigen::Vector2d a = c[1] - c[0], b = c[2] - c[0];
  return 0.5 * (a.x() * b.y() - a.y() * b.x());
}

/// The charts that the triangle reaches into, each with the ways to it.
template <class Visit>
void LayoutSamples::forEachChart(FaceHandle f, const Visit& visit) const {
  const auto& pieces = layout_.pieces[f.idx()];
  for (auto piece = pieces.begin(); piece != pieces.end(); ++piece)
    if (std::none_of(pieces.begin(), piece, [&](const Layout::Piece& earlier) {
          return earlier.chart == piece->chart && earlier.toChart == piece->toChart;
        }))
      visit(piece->chart, piece->toChart);
}

SurfaceSample LayoutSamples::sample(FaceHandle f, const Eigen::Vector3d& barycentric) const {
  const auto& mesh = map_.mesh;
  const Eigen::Vector2d x = at(f, barycentric);
  SurfaceSample s;
  s.point.setZero();
  std::array<Eigen::Vector3d, 3> p;
  HalfedgeHandle h = mesh.halfedge_handle(f);
  std::optional<VertexHandle> vertex;
  for (int k = 0; k < 3; ++k) {
    if (barycentric[k] == 1) vertex = mesh.from_vertex_handle(h);
    p[k] = mesh.point(mesh.from_vertex_handle(h));
    s.point += barycentric[k] * p[k];
    h = mesh.next_halfedge_handle(h);
  }
  const auto& piece = layout_.pieceAt(f, x);
  s.chart = piece.chart;
  s.parameter = regularised(piece.chart, Layout::apply(piece.toChart, layout_.scale, x));
  // On a crease the vertex's own normal belongs to one side only.
  s.normal = s.meshNormal = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
  if (vertex) {
    s.point = vertexPoint_[vertex->idx()];
    s.normal = vertexNormal_[vertex->idx()];
    return s;
  }
  return s;
}

std::vector<SurfaceSample> LayoutSamples::make(const JoinedSpace& space, bool control, int threads,
                                               const Progress& progress) {
  const auto& mesh = map_.mesh;
  const int across = kSamplesAcrossSpan + (control ? 1 : 0);
  std::vector<SurfaceSample> samples;
  cells_.clear();
  if (!control) {
    samples.resize(mesh.n_vertices());
    for (const auto f : mesh.faces()) {
      HalfedgeHandle h = mesh.halfedge_handle(f);
      const double share = kVertexShare * areaOf(f) / 3;
      for (int k = 0; k < 3; ++k, h = mesh.next_halfedge_handle(h)) {
        auto& s = samples[mesh.from_vertex_handle(h).idx()];
        const double weight = s.weight + share;
        if (s.weight == 0) s = sample(f, Eigen::Vector3d::Unit(k));
        s.weight = weight;
      }
    }
  }
  const int first = int(samples.size());
  std::vector<int> onTriangles;
  const auto add = [&](FaceHandle f, const Eigen::Vector3d& barycentric) {
    if (barycentric.maxCoeff() < 1) onTriangles.push_back(int(samples.size()));
    samples.push_back(sample(f, barycentric));
  };
  std::array<std::vector<KnotLattice>, 2> knots;  // by whether finer, and chart
  for (const auto& chart : space.charts)
    for (const int fine : {0, 1}) knots[fine].emplace_back(chart, fine ? 2 * across : across);
  std::vector<std::array<int, 3>> lattice;
  for (const auto f : mesh.faces()) {
    if (f.idx() % 256 == 0) progress.check();
    forEachChart(f, [&](int chart, const Transition& toChart) {
      const Corners c = corners(f, toChart);
      // Towards a singularity the parameters drift apart, so there the lattice is twice as fine.
      const bool fine = isNearSingularity(chart, c, space.charts[chart]);
      for (const auto& point : knots[fine][chart].in(c)) {
        const Eigen::Vector2d x = at(f, point.barycentric);
        const auto& piece = layout_.pieceAt(f, x);
        if (piece.chart != chart || piece.toChart != toChart) continue;
        add(f, point.barycentric);
        samples.back().weight = (control ? 1 : 1 - kVertexShare) * point.area;
        lattice.push_back({2 * chart + fine, point.index[0], point.index[1]});
      }
    });
  }
  if (!control) cells_ = latticeCells(lattice, first);
  for (const auto f : mesh.faces()) {
    HalfedgeHandle h = mesh.halfedge_handle(f);
    for (int k = 0; k < 3; ++k, h = mesh.next_halfedge_handle(h)) {
      if (!bendsAt_[mesh.edge_handle(h).idx()]) continue;
      int parts = 1;
      forEachChart(f, [&](int chart, const Transition& toChart) {
        const Corners c = corners(f, toChart);
        parts = std::max(parts, latticeParts(space.charts[chart], c[k], c[(k + 1) % 3], across));
      });
      const Corners c = corners(f);
      for (int i = 0; i < parts; ++i) {
        Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();
        barycentric[(k + 1) % 3] = (i + 0.5) / parts;
        barycentric[k] = 1 - barycentric[(k + 1) % 3];
        add(f, barycentric);
        samples.back().weight = kBoundaryStrip * (c[(k + 1) % 3] - c[k]).norm() / parts;
      }
    }
  }
  moveOntoTrueSurface(region_, onTriangles, samples, threads, progress);
  return samples;
}

}  // namespace trimquad
