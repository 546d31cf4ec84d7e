#include "trimquad/gridmap/patch_map.h"

#include <algorithm>
#include <set>

#include "trimquad/base/error.h"
#include "trimquad/gridmap/convex_combination.h"
#include "trimquad/gridmap/progressive_embedding.h"

namespace trimquad {
namespace {

using Eigen::Vector2d;

/// Part of the distance between two neighbours on an arc that does not depend on their distance in the map.
constexpr double kUniformPart = 0.1;

std::vector<PatchDisk> patchDisks(const EmbeddedTMesh& embedded) {
  const auto isArc = arcEdges(embedded);
  std::vector<PatchDisk> disks;
  for (std::size_t p = 0; p < embedded.patches.size(); ++p)
    disks.push_back(patchDisk(embedded, isArc, PatchId{int(p)}));
  return disks;
}

/// Inner edges whose two ends lie on one side of their patch.
std::set<EdgeHandle> edgesAlongSides(const EmbeddedTMesh& embedded, const std::vector<PatchDisk>& disks) {
  const auto& mesh = embedded.surface.mesh;
  const auto isArc = arcEdges(embedded);
  std::set<EdgeHandle> found;
  for (const PatchDisk& disk : disks)
    for (std::size_t t = 0; t < disk.faces.size(); ++t) {
      HalfedgeHandle h = mesh.halfedge_handle(disk.faces[t]);
      for (int k = 0; k < 3; ++k, h = mesh.next_halfedge_handle(h)) {
        const int a = disk.triangles[t][k], b = disk.triangles[t][(k + 1) % 3];
        if (disk.isInner(a) || disk.isInner(b) || isArc[mesh.edge_handle(h).idx()]) continue;
        for (int side = 0; side < 4; ++side)
          if (disk.sides[a][side] && disk.sides[b][side]) found.insert(mesh.edge_handle(h));
      }
    }
  return found;
}

class PatchMaps {
 public:
  PatchMaps(const Parametrization& seamless, PatchMap& result)
      : seamless_(seamless), result_(result), embedded_(result.embedded), mesh_(embedded_.surface.mesh) {
    int largest = 1;
    for (const auto& patch : embedded_.patches)
      for (const auto& side : patch.sides) largest = std::max(largest, embedded_.length(side));
    scale_ = FixedScale::fitting(largest);
    for (std::size_t a = 0; a < embedded_.arcs.size(); ++a) placesOnArc_.push_back(placesOn(ArcId{int(a)}));
    corner_.resize(mesh_.n_halfedges());
  }

  void map(PatchId id, const PatchDisk& disk) {
    const auto rim = rimPlaces(id);
    TRIMQUAD_ASSERT(rim.size() == disk.rim.size());
    if (const auto weights = meanValueWeights(shapes(disk)))
      if (const auto image = convexCombination(disk, *weights, rim); image && take(disk, *image)) {
        ++result_.meanValue;
        return;
      }
    const auto image = convexCombination(disk, uniformWeights(disk.triangles.size()), rim);
    if (image && take(disk, *image)) {
      ++result_.uniform;
      return;
    }
    if (const auto embedding = progressiveEmbedding(disk, rim, scale_); embedding && take(disk, *embedding)) {
      ++result_.progressive;
      return;
    }
    throw stageError("optimize", "the map of a patch does not fit the numbers; use a smaller edge length",
                     "patch " + std::to_string(id.index),
                     mesh_.point(mesh_.from_vertex_handle(disk.rim.front())));
  }

  Parametrization assembled() && {
    Parametrization map;
    map.mesh = mesh_;
    map.scale = scale_;
    map.corner = std::move(corner_);
    map.aligned = refinedEdges(seamless_.mesh, embedded_.surface, seamless_.aligned);
    map.featurePoints = seamless_.featurePoints;
    verify(map, true);
    return map;
  }

 private:
  /// Distances of an arc's vertices from its start: nearly as in the seamless map.
  std::vector<Quanta> placesOn(ArcId id) const {
    std::vector<double> along{0};
    for (HalfedgeHandle h : embedded_.halfedges({id, true})) {
      if (mesh_.is_boundary(h)) h = mesh_.opposite_halfedge_handle(h);
      const Vector2d a = imageInChart(seamless_, embedded_.surface, h),
                     b = imageInChart(seamless_, embedded_.surface, mesh_.next_halfedge_handle(h));
      along.push_back(along.back() + (b - a).norm());
    }
    const double edges = double(along.size() - 1), length = embedded_[id].length;
    std::vector<Quanta> places;
    for (std::size_t k = 0; k < along.size(); ++k) {
      const double part = along.back() > 0 ? along[k] / along.back() : double(k) / edges;
      places.push_back(scale_.round(length * ((1 - kUniformPart) * part + kUniformPart * double(k) / edges)));
    }
    places.back() = embedded_[id].length * scale_.one();
    return places;
  }

  /// Images of the rim's vertices on the rectangle, whose first corner is the origin.
  std::vector<FixedVector> rimPlaces(PatchId id) const {
    std::vector<FixedVector> places;
    FixedVector x;
    for (int k = 0; k < 4; ++k)
      for (const HalfArc h : embedded_[id].sides[k]) {
        const auto& along = placesOnArc_[h.arc.index];
        const Quanta length = along.back();
        for (std::size_t i = 0; i + 1 < along.size(); ++i) {
          const Quanta step = h.forward ? along[i] : length - along[along.size() - 1 - i];
          places.push_back(x + rotated({step, 0}, k));
        }
        x = x + rotated({length, 0}, k);
      }
    TRIMQUAD_ASSERT(x == FixedVector{});
    return places;
  }

  std::vector<std::array<Vector2d, 3>> shapes(const PatchDisk& disk) const {
    std::vector<std::array<Vector2d, 3>> all;
    for (const auto f : disk.faces) {
      auto& shape = all.emplace_back();
      HalfedgeHandle h = mesh_.halfedge_handle(f);
      for (int k = 0; k < 3; ++k, h = mesh_.next_halfedge_handle(h))
        shape[k] = imageInChart(seamless_, embedded_.surface, h);
    }
    return all;
  }

  std::optional<std::vector<FixedVector>> convexCombination(const PatchDisk& disk, const EdgeWeights& weights,
                                                            const std::vector<FixedVector>& rim) const {
    std::vector<Vector2d> rimInQuads;
    for (const FixedVector x : rim) rimInQuads.push_back(scale_.toQuads(x));
    const auto image = convexCombinationMap(disk, weights, rimInQuads);
    if (!image) return {};
    std::vector<FixedVector> exact = rim;
    for (std::size_t i = rim.size(); i < image->size(); ++i) {
      if (!(*image)[i].allFinite()) return {};
      exact.push_back(scale_.round((*image)[i]));
    }
    return exact;
  }

  /// Whether all triangles are positive; then the map is that of the patch.
  bool take(const PatchDisk& disk, const std::vector<FixedVector>& exact) {
    for (const auto& t : disk.triangles)
      if (orientation(exact[t[0]], exact[t[1]], exact[t[2]]) <= 0) return false;
    for (std::size_t i = 0; i < disk.faces.size(); ++i) {
      HalfedgeHandle h = mesh_.halfedge_handle(disk.faces[i]);
      for (int k = 0; k < 3; ++k, h = mesh_.next_halfedge_handle(h))
        corner_[h.idx()] = exact[disk.triangles[i][k]];
    }
    return true;
  }

  const Parametrization& seamless_;
  PatchMap& result_;
  const EmbeddedTMesh& embedded_;
  const SurfaceMesh& mesh_;
  FixedScale scale_;
  std::vector<std::vector<Quanta>> placesOnArc_;  ///< by arc
  std::vector<FixedVector> corner_;
};

}  // namespace

PatchMap constructiveMap(const Parametrization& seamless, EmbeddedTMesh embedded, const Progress& progress) {
  PatchMap result;
  result.embedded = std::move(embedded);
  auto disks = patchDisks(result.embedded);
  for (const EdgeHandle e : edgesAlongSides(result.embedded, disks)) {
    splitInMiddle(seamless.mesh, result.embedded.surface, e);
    ++result.splits;
  }
  if (result.splits > 0) disks = patchDisks(result.embedded);
  TRIMQUAD_ASSERT(edgesAlongSides(result.embedded, disks).empty());
  PatchMaps maps(seamless, result);
  for (std::size_t p = 0; p < disks.size(); ++p) {
    progress.report(double(p) / double(disks.size()));
    maps.map(PatchId{int(p)}, disks[p]);
  }
  result.map = std::move(maps).assembled();
  return result;
}

}  // namespace trimquad
