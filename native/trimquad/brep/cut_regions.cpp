#include "trimquad/brep/cut_regions.h"

#include <algorithm>
#include <map>

#include "trimquad/base/disjoint_sets.h"
#include "trimquad/base/error.h"
#include "trimquad/brep/cad_curve.h"
#include "trimquad/brep/cad_surface.h"
#include "trimquad/mesh/join_regions.h"

namespace trimquad {
namespace {

class RegionCutter {
 public:
  RegionCutter(const WeldedShape& shape, const FeatureEdges& features, const std::vector<int>& triangles)
      : cad_(shape.cad),
        mesh_(shape.mesh),
        uses_(shape.uses),
        features_(features),
        triangles_(triangles),
        points_(shape.points),
        reversed_(shape.reversed) {}

  CutModel run() {
    makeCurves();
    const auto groups = triangleGroups();
    for (const auto& triangles : groups) makeRegion(triangles);
    makeShells(groups);
    Eigen::AlignedBox3d box;
    for (const int t : triangles_)
      for (const int v : mesh_.triangles[t].vertex) box.extend(mesh_.vertices[v].point);
    model_.diagonal = box.diagonal().norm();
    auto [joined, surfaces] = joinedSurfaces(groups);
    return {std::move(model_),     std::move(inner_),   std::move(aligned_), std::move(cadEdge_),
            std::move(cadVertex_), std::move(surfaces), std::move(joined)};
  }

 private:
  bool isCut(int side) const {
    const auto& edge = mesh_.sides[side].cadEdge;
    return edge && features_.cut[*edge];
  }

  void makeCurves() {
    curveOfEdge_.resize(cad_.edges.size());
    cornerOfVertex_.resize(cad_.vertices.size());
    std::vector<char> used(cad_.edges.size(), 0);
    for (const int t : triangles_)
      for (const int s : mesh_.triangles[t].side)
        if (isCut(s)) used[*mesh_.sides[s].cadEdge] = 1;
    const auto cornerAt = [&](int vertex) {
      if (!cornerOfVertex_[vertex]) {
        cornerOfVertex_[vertex] = CornerId{int(model_.corners.size())};
        model_.corners.push_back(cad_.vertices[vertex]);
        cadVertex_.push_back(vertex);
      }
      return *cornerOfVertex_[vertex];
    };
    for (size_t e = 0; e < cad_.edges.size(); ++e) {
      if (!used[e]) continue;
      const CadEdge& edge = cad_.edges[e];
      curveOfEdge_[e] = CurveId{int(model_.curves.size())};
      const CornerId start = cornerAt(edge.start), end = cornerAt(edge.end);
      model_.curves.push_back({cadCurve(edge), start, end, edge.name});
      inner_.push_back(features_.inner[e]);
      aligned_.push_back(features_.aligned[e]);
      cadEdge_.push_back(int(e));
    }
  }

  /// Triangles connected across sides that are not cut; in the order of their first triangles.
  std::vector<std::vector<int>> triangleGroups() const {
    DisjointSets groups(mesh_.triangles.size());
    for (const int t : triangles_)
      for (const int s : mesh_.triangles[t].side) {
        if (isCut(s)) continue;
        if (uses_[s].size() == 1)
          throw inputError("tessellate", "the face cannot be triangulated: its wires cross; repair the shape",
                           cad_.faces[mesh_.triangles[t].face].name,
                           mesh_.vertices[mesh_.sides[s].from].point);
        groups.unite(uses_[s][0].first, uses_[s][1].first);
      }
    std::vector<std::vector<int>> result;
    std::vector<int> number(mesh_.triangles.size(), -1);
    for (const int t : triangles_) {
      int& n = number[groups.root(t)];
      if (n < 0) {
        n = int(result.size());
        result.emplace_back();
      }
      result[n].push_back(t);
    }
    return result;
  }

  /// One vertex per fan of triangles around a vertex: the two banks of a slit, and sheets that touch in a
  /// point, get vertices of their own.
  TriangleSoup soupOf(const std::vector<int>& triangles, std::vector<int>& origin) const {
    std::vector<int> place(mesh_.triangles.size(), -1);
    for (size_t i = 0; i < triangles.size(); ++i) place[triangles[i]] = int(i);
    DisjointSets fans(3 * triangles.size());
    for (size_t i = 0; i < triangles.size(); ++i)
      for (int k = 0; k < 3; ++k) {
        const int side = mesh_.triangles[triangles[i]].side[k];
        if (isCut(side)) continue;
        for (const auto& [t, j] : uses_[side]) {
          if (t == triangles[i]) continue;
          fans.unite(int(3 * i + k), 3 * place[t] + (j + 1) % 3);
          fans.unite(int(3 * i + (k + 1) % 3), 3 * place[t] + j);
        }
      }
    TriangleSoup soup;
    std::vector<int> number(3 * triangles.size(), -1);
    for (size_t i = 0; i < triangles.size(); ++i) {
      auto& corner = soup.triangles.emplace_back();
      for (int k = 0; k < 3; ++k) {
        int& n = number[fans.root(int(3 * i + k))];
        if (n < 0) {
          n = int(soup.points.size());
          origin.push_back(mesh_.triangles[triangles[i]].vertex[k]);
          soup.points.push_back(mesh_.vertices[origin.back()].point);
        }
        corner[k] = n;
      }
    }
    return soup;
  }

  void makeRegion(const std::vector<int>& triangles) {
    Region region;
    region.name = "region " + std::to_string(model_.regions.size());
    std::vector<int> origin;
    region.mesh = buildSurfaceMesh(soupOf(triangles, origin));
    region.surface = cadSurface(cad_, mesh_, triangles, reversed_);
    region.edgeCurve.resize(region.mesh.n_edges());
    region.curveParameter.assign(region.mesh.n_vertices(), 0);
    region.corner.resize(region.mesh.n_vertices());
    for (size_t i = 0; i < triangles.size(); ++i) {
      const auto& triangle = mesh_.triangles[triangles[i]];
      HalfedgeHandle h = region.mesh.halfedge_handle(FaceHandle(int(i)));
      while (origin[region.mesh.from_vertex_handle(h).idx()] != triangle.vertex[0])
        h = region.mesh.next_halfedge_handle(h);
      for (int k = 0; k < 3; ++k, h = region.mesh.next_halfedge_handle(h)) {
        if (isCut(triangle.side[k])) putOnCurve(region, h, triangle.vertex[k], mesh_.sides[triangle.side[k]]);
      }
    }
    for (const auto v : region.mesh.vertices())
      if (points_[origin[v.idx()]]) region.featurePoints.push_back(v);
    model_.regions.push_back(std::move(region));
  }

  void putOnCurve(Region& region, HalfedgeHandle h, int from, const WeldedMesh::Side& side) const {
    const CurveId curve = *curveOfEdge_[*side.cadEdge];
    region.edgeCurve[region.mesh.edge_handle(h).idx()] = curve;
    const bool along = side.from == from;
    for (const bool first : {true, false}) {
      const auto v = first ? region.mesh.from_vertex_handle(h) : region.mesh.to_vertex_handle(h);
      const int vertex = first == along ? side.from : side.to;
      if (const auto& cadVertex = mesh_.vertices[vertex].cadVertex) {
        region.corner[v.idx()] = cornerOfVertex_[*cadVertex];
        continue;
      }
      const double t = first == along ? side.first : side.last;
      region.curveParameter[v.idx()] = t;
      region.mesh.set_point(v, model_.curves[curve.index].curve->point(t));
    }
  }

  /// Regions that share a curve bound one shell. Several shells of a solid (cavities) name the same solid.
  void makeShells(const std::vector<std::vector<int>>& groups) {
    DisjointSets shells(groups.size());
    std::vector<int> regionOfCurve(model_.curves.size(), -1);
    for (int r = 0; r < int(groups.size()); ++r)
      for (const auto& curve : model_.regions[r].edgeCurve) {
        if (!curve) continue;
        int& other = regionOfCurve[curve->index];
        if (other >= 0)
          shells.unite(r, other);
        else
          other = r;
      }
    std::map<int, int> shellOfRoot;
    for (int r = 0; r < int(groups.size()); ++r) {
      const auto [entry, isNew] = shellOfRoot.emplace(shells.root(r), int(model_.shells.size()));
      if (isNew) model_.shells.push_back({{}, cad_.faces[mesh_.triangles[groups[r].front()].face].solid});
      model_.shells[entry->second].regions.push_back(r);
    }
  }

  /// Triangles and surfaces of the regions after joining.
  std::pair<std::vector<std::vector<int>>, std::vector<std::shared_ptr<const TrueSurface>>> joinedSurfaces(
      const std::vector<std::vector<int>>& groups) const {
    const std::vector<int> joined = joinedRegions(model_, inner_);
    std::vector<std::vector<int>> triangles;
    std::vector<int> parts, part;
    for (size_t r = 0; r < joined.size(); ++r) {
      if (joined[r] == int(triangles.size()))
        triangles.emplace_back(), parts.push_back(0), part.push_back(int(r));
      auto& all = triangles[joined[r]];
      all.insert(all.end(), groups[r].begin(), groups[r].end());
      ++parts[joined[r]];
    }
    std::vector<std::shared_ptr<const TrueSurface>> surfaces;
    for (size_t j = 0; j < triangles.size(); ++j)
      surfaces.push_back(parts[j] == 1 ? model_.regions[part[j]].surface
                                       : cadSurface(cad_, mesh_, triangles[j], reversed_));
    for (auto& all : triangles) std::sort(all.begin(), all.end());
    return {std::move(triangles), std::move(surfaces)};
  }

  const CadModel& cad_;
  const WeldedMesh& mesh_;
  const SideUses& uses_;
  const FeatureEdges& features_;
  const std::vector<int>& triangles_;
  const std::vector<char>&points_, &reversed_;
  std::vector<std::optional<CurveId>> curveOfEdge_;
  std::vector<std::optional<CornerId>> cornerOfVertex_;
  Model model_;
  std::vector<char> inner_, aligned_;  ///< by curve
  std::vector<int> cadEdge_;           ///< by curve
  std::vector<int> cadVertex_;         ///< by corner
};

}  // namespace

CutModel cutRegions(const WeldedShape& shape, const FeatureEdges& features,
                    const std::vector<int>& triangles) {
  return RegionCutter(shape, features, triangles).run();
}

}  // namespace trimquad
