#include "trimquad/mesh/remesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "trimquad/base/error.h"
#include "trimquad/mesh/working_mesh.h"

namespace trimquad {
namespace {

using Eigen::Vector3d;

constexpr int kRounds = 7;
constexpr int kSplitPasses = 12, kFlipPasses = 8, kSmoothings = 2;
constexpr double kLong = 4. / 3, kShort = 4. / 5;
constexpr double kBad = 0.05;    ///< quality under which a triangle is to go
constexpr double kUsable = 0.1;  ///< quality that a collapse must leave, unless it was worse before

/// Finds the parameters of boundary edges from their vertices; the corner of a closed curve is both its ends.
class BoundaryParameters {
 public:
  BoundaryParameters(const WorkingMesh& work, const Model& model) : work_(work), model_(model) {
    for (const auto e : work.mesh.edges()) {
      if (!work.mesh.is_boundary(e)) continue;
      for (const int side : {0, 1}) {
        const auto v = work.mesh.to_vertex_handle(work.mesh.halfedge_handle(e, side));
        if (work.corner[v.idx()]) continue;
        const auto [entry, isNew] = smallest_.emplace(*work.edgeCurve[e.idx()], work.parameter[v.idx()]);
        if (!isNew) entry->second = std::min(entry->second, work.parameter[v.idx()]);
      }
    }
  }

  /// First for halfedge 0's start, then its end.
  std::array<double, 2> ends(EdgeHandle e) const {
    const auto h = work_.mesh.halfedge_handle(e, 0);
    const auto a = work_.mesh.from_vertex_handle(h), b = work_.mesh.to_vertex_handle(h);
    const CurveId curve = work_.edgeCurve[e.idx()].value();
    return {end(curve, a, b), end(curve, b, a)};
  }

 private:
  double end(CurveId id, VertexHandle v, VertexHandle other) const {
    if (!work_.corner[v.idx()]) return work_.parameter[v.idx()];
    const ModelCurve& curve = model_.curves[id.index];
    if (curve.start != curve.end)
      return *work_.corner[v.idx()] == curve.start ? curve.curve->first() : curve.curve->last();
    return work_.parameter[other.idx()] == smallest_.at(id) ? curve.curve->first() : curve.curve->last();
  }

  const WorkingMesh& work_;
  const Model& model_;
  std::map<CurveId, double> smallest_;
};

/// Gives every boundary curve the vertices of its division; those that were there before may still be
/// between.
void insertDivision(WorkingMesh& work, const Model& model, const std::vector<std::vector<double>>& division) {
  const BoundaryParameters parameters(work, model);
  struct Piece {
    EdgeHandle edge;
    std::array<double, 2> ends;
  };
  std::vector<Piece> pieces;
  for (const auto e : work.mesh.edges())
    if (work.mesh.is_boundary(e)) pieces.push_back({e, parameters.ends(e)});
  for (const auto& piece : pieces) {
    const CurveId id = work.edgeCurve[piece.edge.idx()].value();
    const auto& wanted = division[id.index];
    const auto h = work.mesh.halfedge_handle(piece.edge, 0);
    VertexHandle from = work.mesh.from_vertex_handle(h), to = work.mesh.to_vertex_handle(h);
    auto [first, last] = piece.ends;
    if (first > last) std::swap(first, last), std::swap(from, to);
    const double same = 1e-6 * (wanted.back() - wanted.front()) / double(wanted.size());
    for (size_t k = 1; k + 1 < wanted.size(); ++k) {
      const double t = wanted[k];
      const auto at = [&](VertexHandle v) {
        if (work.corner[v.idx()]) return;
        work.parameter[v.idx()] = t;
        work.mesh.set_point(v, model.curves[id.index].curve->point(t));
        work.fixed[v.idx()] = 1;
      };
      if (std::abs(t - first) <= same)
        at(from);
      else if (std::abs(t - last) <= same)
        at(to);
      else if (t > first && t < last) {
        const auto e = work.mesh.edge_handle(work.mesh.find_halfedge(from, to));
        from = work.splitBoundary(e, t, model.curves[id.index].curve->point(t));
        work.fixed[from.idx()] = 1;
      }
    }
  }
}

/// Where a boundary vertex cannot move into its neighbour because both are joined to a third one, the edge to
/// that one is cut, after which it can.
void clearLink(WorkingMesh& work, HalfedgeHandle h) {
  const auto v = work.mesh.from_vertex_handle(h), to = work.mesh.to_vertex_handle(h);
  std::vector<EdgeHandle> obstacles;
  const auto apexOf = [&](HalfedgeHandle g) {
    return work.mesh.is_boundary(g) ? VertexHandle()
                                    : work.mesh.to_vertex_handle(work.mesh.next_halfedge_handle(g));
  };
  const auto apex = apexOf(h), opposite = apexOf(work.mesh.opposite_halfedge_handle(h));
  for (auto out = work.mesh.cvoh_begin(v); out.is_valid(); ++out) {
    const auto x = work.mesh.to_vertex_handle(*out);
    if (x != to && x != apex && x != opposite && work.mesh.find_halfedge(x, to).is_valid() &&
        !work.mesh.is_boundary(work.mesh.edge_handle(*out)))
      obstacles.push_back(work.mesh.edge_handle(*out));
  }
  for (const auto e : obstacles) work.splitInner(e, true);
}

/// Moves boundary vertices that are not wanted into a neighbour. Returns how many are left.
int removeUnwanted(WorkingMesh& work, bool force) {
  int left = 0;
  for (const auto v : work.mesh.vertices()) {
    if (work.fixed[v.idx()] || !work.mesh.is_boundary(v)) continue;
    const auto out = work.mesh.halfedge_handle(v);
    const auto in = work.mesh.opposite_halfedge_handle(work.mesh.prev_halfedge_handle(out));
    if (force)
      for (const auto h : {out, in}) clearLink(work, h);
    const double before = work.worstAround(v, work.mesh.point(v));
    HalfedgeHandle best;
    double quality = force ? -2 : std::min(before, kUsable);
    for (const auto h : {out, in})
      if (const auto after = work.qualityAfterCollapse(h); after && *after >= quality)
        best = h, quality = *after;
    if (best.is_valid())
      work.collapse(best);
    else
      ++left;
  }
  return left;
}

void flipAll(WorkingMesh& work) {
  for (int pass = 0; pass < kFlipPasses; ++pass) {
    bool any = false;
    for (const auto e : work.mesh.edges()) any |= work.flipIfBetter(e);
    if (!any) return;
  }
}

void splitLong(WorkingMesh& work, const Progress& progress) {
  for (int pass = 0; pass < kSplitPasses; ++pass) {
    progress.check();
    std::vector<EdgeHandle> longEdges;
    for (const auto e : work.mesh.edges())
      if (!work.mesh.is_boundary(e) && work.length(e) > kLong * work.wantedLength(e)) longEdges.push_back(e);
    bool any = false;
    // Splits keep the other edges' handles; a long edge that got its new half is looked at again in the next
    // pass.
    for (const auto e : longEdges) any |= work.splitInner(e, false);
    if (!any) return;
    flipAll(work);
  }
}

/// Whether moving v into the boundary vertex `to` would join `to` with further boundary vertices.
bool makesChord(const WorkingMesh& work, VertexHandle v, VertexHandle to) {
  if (!work.mesh.is_boundary(to)) return false;
  for (auto n = work.mesh.cvv_begin(v); n.is_valid(); ++n)
    if (*n != to && work.mesh.is_boundary(*n) && !work.mesh.find_halfedge(*n, to).is_valid()) return true;
  return false;
}

/// Whether moving v into `to` would join `to` with vertices too far away; those that it is joined with are no
/// reason against it.
bool makesLongEdge(const WorkingMesh& work, VertexHandle v, VertexHandle to) {
  for (auto n = work.mesh.cvv_begin(v); n.is_valid(); ++n)
    if (!work.mesh.find_halfedge(*n, to).is_valid() &&
        (work.mesh.point(*n) - work.mesh.point(to)).norm() >
            kLong * 0.5 * (work.size[n->idx()] + work.size[to.idx()]))
      return true;
  return false;
}

void collapseShort(WorkingMesh& work) {
  for (const auto e : work.mesh.edges()) {
    if (work.mesh.is_boundary(e) || work.length(e) >= kShort * work.wantedLength(e)) continue;
    HalfedgeHandle best;
    double quality = -2;
    for (const int side : {0, 1}) {
      const auto h = work.mesh.halfedge_handle(e, side);
      const auto v = work.mesh.from_vertex_handle(h), to = work.mesh.to_vertex_handle(h);
      if (work.isHeld(v) || makesChord(work, v, to) || makesLongEdge(work, v, to)) continue;
      const auto after = work.qualityAfterCollapse(h);
      if (!after || *after < std::min(kUsable, work.worstAround(v, work.mesh.point(v)))) continue;
      if (*after > quality) best = h, quality = *after;
    }
    if (best.is_valid()) work.collapse(best);
  }
}

/// The least quality that a collapse out of a bad triangle must leave. On a ridge, where normals say little
/// and several slivers lie side by side, none worse than before: all of them have to go. A vertex inside a
/// triangle leaves that one, which is as flat as those before.
double leastQuality(const WorkingMesh& work, FaceHandle bad, VertexHandle v, VertexHandle to) {
  if (!work.onRidge[v.idx()] && !work.onRidge[to.idx()]) return std::nextafter(work.quality(bad), 2);
  return work.worstAround(v, work.mesh.point(v)) - (work.mesh.valence(v) == 3 ? kBad : 0);
}

/// Takes out folded triangles and slivers by whichever collapse leaves the best triangles, whatever the
/// lengths.
void collapseBad(WorkingMesh& work) {
  for (const auto f : work.mesh.faces()) {
    if (work.quality(f) >= kBad) continue;
    HalfedgeHandle best;
    double quality = -2;
    for (auto side = work.mesh.cfh_begin(f); side.is_valid(); ++side)
      for (const HalfedgeHandle h :
           {HalfedgeHandle(*side), HalfedgeHandle(work.mesh.opposite_halfedge_handle(*side))}) {
        const auto v = work.mesh.from_vertex_handle(h), to = work.mesh.to_vertex_handle(h);
        if (work.isHeld(v) || makesChord(work, v, to)) continue;
        if (const auto after = work.qualityAfterCollapse(h);
            after && *after > quality && *after >= leastQuality(work, f, v, to))
          best = h, quality = *after;
      }
    if (best.is_valid()) work.collapse(best);
  }
}

void smoothAll(WorkingMesh& work) {
  for (int i = 0; i < kSmoothings; ++i)
    for (const auto v : work.mesh.vertices())
      if (!work.isHeld(v)) work.smooth(v);
}

/// Every triangle gets an inner vertex.
void splitChords(WorkingMesh& work) {
  std::vector<EdgeHandle> chords;
  for (const auto e : work.mesh.edges())
    if (work.isChord(e)) chords.push_back(e);
  for (const auto e : chords) work.splitInner(e, true);
  std::vector<FaceHandle> enclosed;
  for (const auto f : work.mesh.faces()) {
    bool inner = false;
    for (auto v = work.mesh.cfv_begin(f); v.is_valid(); ++v) inner |= !work.mesh.is_boundary(*v);
    if (!inner) enclosed.push_back(f);
  }
  for (const auto f : enclosed) work.splitFace(f);
}

}  // namespace

void remesh(Region& region, const Model& model, const std::vector<std::vector<double>>& division,
            const RemeshOptions& options, const Progress& progress) {
  WorkingMesh work(region, options);
  insertDivision(work, model, division);
  flipAll(work);
  int unwanted = removeUnwanted(work, false);
  for (int round = 0; round < kRounds; ++round) {
    progress.check();
    work.updateSizes();
    if (round + 1 < kRounds) splitLong(work, progress);
    if (unwanted > 0) unwanted = removeUnwanted(work, round > 1);
    collapseShort(work);
    flipAll(work);
    collapseBad(work);
    smoothAll(work);
  }
  if (unwanted > 0)
    throw stageError("tessellate",
                     "the boundary cannot be divided into the wanted edges; choose a shorter edge length",
                     region.name);
  splitChords(work);
  for (int i = 0; i < 2; ++i) {
    flipAll(work);
    collapseBad(work);
    smoothAll(work);
  }
  flipAll(work);
  work.finish(region);
}

}  // namespace trimquad
