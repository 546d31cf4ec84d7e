#include "trimquad/brep/region_parts.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "trimquad/base/disjoint_sets.h"
#include "trimquad/mesh/aabb_tree.h"

// This order: OpenCASCADE's macros must not reach the mesh headers.
#include "trimquad/brep/meshed_regions.h"
#include "trimquad/brep/occt_guard.h"

#include <Geom_BSplineSurface.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>

namespace trimquad {
namespace {

using Eigen::Vector3d;

constexpr int kFewestPoles = 16;  ///< that a face counts for

/// A CAD edge inside a region, where the region is not open.
struct InnerEdge {
  int edge;
  std::set<int> faces;  ///< one for a seam
};

class InnerEdges {
 public:
  InnerEdges(const CadOrigin& origin, int region)
      : origin_(origin), shape_(*origin.shape), triangles_(origin.triangles[region]) {
    std::vector<char> mine(shape_.mesh.triangles.size(), 0);
    for (const int t : triangles_) mine[t] = 1;
    std::map<int, std::set<int>> faces;
    std::set<int> foreign;  // edges that reach into another region
    for (size_t s = 0; s < shape_.uses.size(); ++s) {
      const auto& edge = shape_.mesh.sides[s].cadEdge;
      const auto& uses = shape_.uses[s];
      if (!edge || uses.size() != 2 || (origin.features.cut[*edge] && !origin.features.inner[*edge]))
        continue;
      for (const auto& use : uses) {
        if (mine[use.first])
          faces[*edge].insert(shape_.mesh.triangles[use.first].face);
        else
          foreign.insert(*edge);
      }
    }
    for (auto& [edge, sides] : faces)
      if (!foreign.count(edge)) edges_.push_back({edge, std::move(sides)});
  }

  /// Those along which the surface bends as sharply as at an edge, on some of their length.
  std::vector<int> creased() const {
    std::set<int> bent;
    for (const int t : triangles_)
      for (const int s : shape_.mesh.triangles[t].side)
        if (origin_.features.crease[s]) bent.insert(*shape_.mesh.sides[s].cadEdge);
    return separating([&](const InnerEdge& inner) { return bent.count(inner.edge) > 0; });
  }

  /// Around the faces within `reach` of a place.
  std::vector<int> around(const Vector3d& place, double reach) const {
    std::map<int, double> distance;
    for (const int t : triangles_) {
      const auto& triangle = shape_.mesh.triangles[t];
      std::array<Vector3d, 3> corner;
      for (int k = 0; k < 3; ++k) corner[k] = shape_.mesh.vertices[triangle.vertex[k]].point;
      const Vector3d w = closestOnTriangle(place, corner[0], corner[1], corner[2]);
      const double away = (w[0] * corner[0] + w[1] * corner[1] + w[2] * corner[2] - place).norm();
      const auto [entry, isNew] = distance.emplace(triangle.face, away);
      if (!isNew) entry->second = std::min(entry->second, away);
    }
    double nearest = HUGE_VAL;
    for (const auto& [face, away] : distance) nearest = std::min(nearest, away);
    const auto isThere = [&](int face) { return distance.at(face) <= nearest + reach; };
    return separating(
        [&](const InnerEdge& inner) { return std::any_of(inner.faces.begin(), inner.faces.end(), isThere); });
  }

  std::vector<int> betweenFaces() const {
    return separating([](const InnerEdge&) { return true; });
  }

  /// Of a region of one face.
  std::vector<int> seams() const {
    std::vector<int> chosen;
    for (const auto& inner : edges_) {
      if (inner.faces.size() == 2) return {};
      if (!origin_.features.aligned[inner.edge]) chosen.push_back(inner.edge);
    }
    return chosen;
  }

 private:
  /// Those of the edges between two faces for which `wanted` holds that have different parts on both hands if
  /// all of these are cut.
  template <class Wanted>
  std::vector<int> separating(const Wanted& wanted) const {
    std::vector<int> chosen;
    for (const auto& inner : edges_)
      if (inner.faces.size() == 2 && wanted(inner)) chosen.push_back(inner.edge);
    std::vector<char> cut = origin_.features.cut;
    for (size_t e = 0; e < cut.size(); ++e)
      if (origin_.features.inner[e]) cut[e] = 0;
    for (const int e : chosen) cut[e] = 1;
    const auto isCut = [&](int s) {
      const auto& edge = shape_.mesh.sides[s].cadEdge;
      return edge && cut[*edge];
    };
    DisjointSets parts(shape_.mesh.triangles.size());
    for (const int t : triangles_)
      for (const int s : shape_.mesh.triangles[t].side)
        if (!isCut(s)) parts.unite(shape_.uses[s][0].first, shape_.uses[s][1].first);
    std::set<int> useful;
    for (const int t : triangles_)
      for (const int s : shape_.mesh.triangles[t].side) {
        const auto& uses = shape_.uses[s];
        if (isCut(s) && uses.size() == 2 && parts.root(uses[0].first) != parts.root(uses[1].first))
          useful.insert(*shape_.mesh.sides[s].cadEdge);
      }
    std::vector<int> result;
    for (const int e : chosen)
      if (useful.count(e)) result.push_back(e);
    return result;
  }

  const CadOrigin& origin_;
  const WeldedShape& shape_;
  const std::vector<int>& triangles_;
  std::vector<InnerEdge> edges_;
};

/// Makes the feature points of a whole those of its parts. Returns the ones on curves.
std::vector<CurvePoint> pinAgain(const Region& whole, const CadOrigin& origin, CutModel& cut,
                                 const std::vector<std::vector<double>>& division) {
  FeatureOptions options;
  options.quadLength = origin.quadLength;
  for (const auto v : whole.featurePoints) options.points.push_back(whole.mesh.point(v));
  if (options.points.empty()) return {};
  auto points = pinPoints(cut.model, options);
  // On a curve that neighbours end on as well, the point is one of its division already.
  for (auto& [curve, t] : points) {
    const auto& parameters = division[curve.index];
    if (origin.division[cut.cadEdge[curve.index]].empty()) continue;
    t = *std::min_element(parameters.begin(), parameters.end(),
                          [t = t](double a, double b) { return std::abs(a - t) < std::abs(b - t); });
  }
  return points;
}

RegionParts partsAlong(const Model& model, int index, std::vector<int> edges, bool seams,
                       const Progress& progress) {
  const CadOrigin& origin = *model.origin;
  FeatureEdges features = origin.features;
  cutAlong(features, origin.shape->mesh, edges);
  CutModel cut = cutRegions(*origin.shape, features, origin.triangles[index]);
  auto division = divideCurves(cut.model, origin.remeshing);
  std::vector<CurvePoint> fresh;
  for (size_t c = 0; c < division.size(); ++c)
    if (const auto& known = origin.division[cut.cadEdge[c]]; !known.empty()) division[c] = known;
  const auto points = pinAgain(model.regions[index], origin, cut, division);
  for (const auto& point : points)
    if (origin.division[cut.cadEdge[point.curve.index]].empty()) fresh.push_back(point);
  divideAt(fresh, division);
  // A slit of one piece would close by itself.
  for (size_t c = 0; c < division.size(); ++c) {
    auto& parameters = division[c];
    if (seams && parameters.size() == 2 && origin.division[cut.cadEdge[c]].empty())
      parameters.insert(parameters.begin() + 1, 0.5 * (parameters.front() + parameters.back()));
  }
  RegionParts parts;
  parts.model = meshedRegions(cut, points, division, origin.remeshing, progress);
  for (size_t c = 0; c < division.size(); ++c) {
    if (cut.inner[c]) continue;
    parts.division.push_back(std::move(division[c]));
    parts.cadEdge.push_back(cut.cadEdge[c]);
  }
  parts.cadVertex = cut.cadVertex;
  parts.triangles = std::move(cut.triangles);
  for (const int e : edges) parts.edges.push_back(origin.shape->cad.edges[e].name);
  parts.cut = std::move(edges);
  return parts;
}

/// Adds the parts' curves and corners to a model, and gives the parts their numbers there.
std::vector<Region> adopted(const RegionParts& parts, const std::string& name, Model& model,
                            CadOrigin& origin) {
  std::vector<CornerId> corner;
  for (size_t c = 0; c < parts.cadVertex.size(); ++c) {
    auto& known = origin.corner[parts.cadVertex[c]];
    if (!known) {
      known = CornerId{int(model.corners.size())};
      model.corners.push_back(parts.model.corners[c]);
    }
    corner.push_back(*known);
  }
  std::vector<CurveId> curve;
  for (size_t c = 0; c < parts.cadEdge.size(); ++c) {
    auto& known = origin.curve[parts.cadEdge[c]];
    if (!known) {
      known = CurveId{int(model.curves.size())};
      ModelCurve added = parts.model.curves[c];
      added.start = corner[added.start.index];
      added.end = corner[added.end.index];
      model.curves.push_back(std::move(added));
      origin.division[parts.cadEdge[c]] = parts.division[c];
    }
    curve.push_back(*known);
  }
  std::vector<Region> regions = parts.model.regions;
  for (size_t p = 0; p < regions.size(); ++p) {
    regions[p].name = name + "." + std::to_string(p + 1);
    for (auto& id : regions[p].edgeCurve)
      if (id) id = curve[id->index];
    for (auto& id : regions[p].corner)
      if (id) id = corner[id->index];
  }
  return regions;
}

}  // namespace

std::optional<RegionParts> regionParts(const Model& model, int region, const CutPlace& where,
                                       const Progress& progress) {
  if (!model.origin) return {};
  return guarded(Error::Kind::Stage, "tessellate", "OpenCASCADE cannot cut the region",
                 [&]() -> std::optional<RegionParts> {
                   const InnerEdges inner(*model.origin, region);
                   std::vector<int> edges;
                   if (where.creases) {
                     edges = inner.creased();
                   } else {
                     if (where.point) edges = inner.around(*where.point, model.origin->remeshing.tolerance);
                     if (edges.empty()) edges = inner.betweenFaces();
                   }
                   const bool seams = edges.empty() && !where.creases;
                   if (seams) edges = inner.seams();
                   if (edges.empty()) return {};
                   return partsAlong(model, region, std::move(edges), seams, progress);
                 });
}

std::optional<int> cadPoles(const Model& model, int region) {
  if (!model.origin) return {};
  std::set<int> faces;
  const WeldedShape& shape = *model.origin->shape;
  for (const int t : model.origin->triangles[region]) faces.insert(shape.mesh.triangles[t].face);
  if (faces.size() < 2) return {};
  int poles = 0;
  for (const int f : faces) {
    Handle(Geom_Surface) surface = shape.cad.faces[f].surface;
    while (const auto trimmed = Handle(Geom_RectangularTrimmedSurface)::DownCast(surface))
      surface = trimmed->BasisSurface();
    const auto spline = Handle(Geom_BSplineSurface)::DownCast(surface);
    poles += std::max(kFewestPoles, spline.IsNull() ? 0 : spline->NbUPoles() * spline->NbVPoles());
  }
  return poles;
}

Model withParts(const Model& model, const std::map<int, const RegionParts*>& parts) {
  CadOrigin origin = *model.origin;
  Model result = model;
  result.regions.clear();
  origin.triangles.clear();
  std::vector<std::vector<int>> became(model.regions.size());
  for (int r = 0; r < int(model.regions.size()); ++r) {
    const int first = int(result.regions.size());
    if (const auto found = parts.find(r); found != parts.end()) {
      const RegionParts& cut = *found->second;
      for (auto& part : adopted(cut, model.regions[r].name, result, origin))
        result.regions.push_back(std::move(part));
      origin.triangles.insert(origin.triangles.end(), cut.triangles.begin(), cut.triangles.end());
      cutAlong(origin.features, origin.shape->mesh, cut.cut);
    } else {
      result.regions.push_back(model.regions[r]);
      origin.triangles.push_back(model.origin->triangles[r]);
    }
    for (int k = first; k < int(result.regions.size()); ++k) became[r].push_back(k);
  }
  for (auto& shell : result.shells) {
    std::vector<int> regions;
    for (const int r : shell.regions) regions.insert(regions.end(), became[r].begin(), became[r].end());
    shell.regions = std::move(regions);
  }
  result.origin = std::make_shared<const CadOrigin>(std::move(origin));
  return result;
}

}  // namespace trimquad
