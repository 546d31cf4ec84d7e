#include "trimquad/brep/deviation_map.h"

#include <map>
#include <optional>
#include <utility>

// Before OpenCASCADE, whose macro Handle() breaks OpenMesh.
#include "trimquad/base/parallel.h"
#include "trimquad/mesh/triangle_surface.h"

#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <Poly_Triangulation.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>

#include "trimquad/brep/assemble.h"
#include "trimquad/brep/occt_guard.h"

namespace trimquad {
namespace {

/// Radians between the normals of neighbouring triangles. Large, since the size of the triangles bounds it
/// too.
constexpr double kMapAngle = 0.5;
/// OpenCASCADE cannot triangulate some faces at one deflection that it can at another.
constexpr int kAttempts = 3;

/// Triangles in the parameter plane of a surface, and their corners on it.
class FaceTriangles {
 public:
  FaceTriangles(const SplineSurface& surface, const TopoDS_Face& face) : surface_(surface) {
    TopLoc_Location location;
    const Handle(Poly_Triangulation) found = BRep_Tool::Triangulation(face, location);
    for (int i = 1; i <= found->NbNodes(); ++i) add({found->UVNode(i).X(), found->UVNode(i).Y()});
    for (int i = 1; i <= found->NbTriangles(); ++i) {
      int a, b, c;
      found->Triangle(i).Get(a, b, c);
      triangles_.push_back({a - 1, b - 1, c - 1});
    }
  }

  /// Halves triangles at their longest side until none is longer.
  void divide(double longest) {
    std::map<std::pair<int, int>, int> middles;
    for (std::size_t t = 0; t < triangles_.size();) {
      const auto corner = triangles_[t];
      const auto length = [&](int k) { return (points_[corner[k]] - points_[corner[(k + 1) % 3]]).norm(); };
      int side = 0;
      for (const int k : {1, 2})
        if (length(k) > length(side)) side = k;
      if (length(side) <= longest) {
        ++t;
        continue;
      }
      const int a = corner[side], b = corner[(side + 1) % 3], c = corner[(side + 2) % 3];
      const auto [middle, isNew] = middles.try_emplace(std::minmax(a, b), int(points_.size()));
      if (isNew) add(0.5 * (parameters_[a] + parameters_[b]));
      triangles_[t] = {a, middle->second, c};
      triangles_.push_back({middle->second, b, c});
    }
  }

  DeviationMap map(const Region& region, const std::optional<TriangleTree>& tree,
                   const DeviationMapOptions& options, const Progress& progress) && {
    std::vector<double> distances(points_.size());
    parallelParts(int(points_.size()), options.threads, [&](int begin, int end) {
      progress.check();
      for (int i = begin; i < end; ++i) {
        const auto jet = surface_.jet(parameters_[i][0], parameters_[i][1]);
        const Eigen::Vector3d normal = jet.su.cross(jet.sv).normalized();
        distances[i] = (points_[i] - foot(region, tree, points_[i], normal)).norm();
      }
    });
    return {std::move(points_), std::move(distances), std::move(triangles_)};
  }

 private:
  static Eigen::Vector3d foot(const Region& region, const std::optional<TriangleTree>& tree,
                              const Eigen::Vector3d& p, const Eigen::Vector3d& normal) {
    if (region.surface) return region.surface->closestFacing(p, normal).point;
    const auto hit = tree->closestFacing(p, normal);
    return hit ? hit->point : tree->closest(p).point;
  }

  void add(const Eigen::Vector2d& parameter) {
    parameters_.push_back(parameter);
    points_.push_back(surface_.point(parameter[0], parameter[1]));
  }

  const SplineSurface& surface_;
  std::vector<Eigen::Vector2d> parameters_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<std::array<int, 3>> triangles_;
};

bool triangulated(const TopoDS_Face& face, double chord) {
  BRepMesh_IncrementalMesh(face, chord, false, kMapAngle, false);
  TopLoc_Location location;
  return !BRep_Tool::Triangulation(face, location).IsNull();
}

}  // namespace

std::vector<DeviationMap> deviationMaps(const SplineModel& model, const std::vector<const Region*>& regions,
                                        const DeviationMapOptions& options, const Progress& progress) {
  return guarded(Error::Kind::Stage, "write", "the trimmed surfaces cannot be triangulated", [&] {
    std::vector<std::optional<TriangleTree>> trees(regions.size());
    for (std::size_t r = 0; r < regions.size(); ++r)
      if (regions[r] && !regions[r]->surface) trees[r] = triangleTree(regions[r]->mesh);
    const auto shapes = assembledFaces(model);
    std::vector<DeviationMap> maps;
    for (std::size_t f = 0; f < shapes.size(); ++f) {
      progress.check();
      const SplineFace& face = model.faces[f];
      const Region& region = *regions[face.region];
      const TopoDS_Face& shape = TopoDS::Face(shapes[f].topology());
      double chord = options.chord;
      for (int attempt = 1; !triangulated(shape, chord); ++attempt, chord *= 0.4)
        if (attempt == kAttempts)
          throw stageError("write", "OpenCASCADE cannot triangulate a B-spline face; use a smaller tolerance",
                           region.name);
      FaceTriangles triangles(face.surface, shape);
      triangles.divide(options.size);
      maps.push_back(std::move(triangles).map(region, trees[face.region], options, progress));
    }
    return maps;
  });
}

}  // namespace trimquad
