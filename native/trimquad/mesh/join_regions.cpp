#include "trimquad/mesh/join_regions.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <variant>

#include "trimquad/base/disjoint_sets.h"
#include "trimquad/base/error.h"

namespace trimquad {
namespace {

/// Where a vertex lies on a curve: in a corner, or at a parameter.
using CurvePlace = std::variant<CornerId, double>;

CurvePlace placeOf(const Region& region, VertexHandle v) {
  if (const auto& corner = region.corner[v.idx()]) return *corner;
  return region.curveParameter[v.idx()];
}

class RegionJoin {
 public:
  RegionJoin(const Model& parts, const std::vector<char>& inner)
      : parts_(parts), inner_(inner), group_(joinedRegions(parts, inner)), glued_(vertexCount(parts)) {
    int first = 0;
    for (const auto& part : parts.regions) {
      firstVertex_.push_back(first);
      first += int(part.mesh.n_vertices());
    }
  }

  Model run(const std::vector<std::shared_ptr<const TrueSurface>>& surfaces) {
    glueSegments();
    model_.corners = parts_.corners;
    model_.diagonal = parts_.diagonal;
    for (std::size_t c = 0; c < parts_.curves.size(); ++c) {
      curve_.push_back({int(model_.curves.size())});
      if (!inner_[c]) model_.curves.push_back(parts_.curves[c]);
    }
    for (std::size_t r = 0; r < surfaces.size(); ++r) addRegion(int(r), surfaces[r]);
    addShells();
    return std::move(model_);
  }

 private:
  struct Side {
    int part;
    HalfedgeHandle boundary;
  };

  static std::size_t vertexCount(const Model& parts) {
    std::size_t count = 0;
    for (const auto& part : parts.regions) count += part.mesh.n_vertices();
    return count;
  }
  int number(int part, VertexHandle v) const { return firstVertex_[part] + v.idx(); }

  void glueSegments() {
    std::map<std::tuple<CurveId, CurvePlace, CurvePlace>, std::vector<Side>> segments;
    for (int p = 0; p < int(parts_.regions.size()); ++p) {
      const auto& part = parts_.regions[p];
      for (const auto h : part.mesh.halfedges()) {
        if (!part.mesh.is_boundary(h)) continue;
        const CurveId curve = part.edgeCurve[part.mesh.edge_handle(h).idx()].value();
        if (!inner_[curve.index]) continue;
        const auto [a, b] = std::minmax(
            {placeOf(part, part.mesh.from_vertex_handle(h)), placeOf(part, part.mesh.to_vertex_handle(h))});
        segments[{curve, a, b}].push_back({p, h});
      }
    }
    for (const auto& [key, sides] : segments) {
      TRIMQUAD_ASSERT(sides.size() == 2);
      const auto ends = [&](const Side& side) {
        const auto& mesh = parts_.regions[side.part].mesh;
        return std::pair{number(side.part, mesh.from_vertex_handle(side.boundary)),
                         number(side.part, mesh.to_vertex_handle(side.boundary))};
      };
      const auto [from, to] = ends(sides[0]);
      const auto [otherFrom, otherTo] = ends(sides[1]);
      glued_.unite(from, otherTo);
      glued_.unite(to, otherFrom);
    }
  }

  void addRegion(int r, const std::shared_ptr<const TrueSurface>& surface) {
    Region region;
    region.name = "region " + std::to_string(r);
    region.surface = surface;
    TriangleSoup soup;
    std::map<int, int> vertex;  // by glued vertex: its number in the region
    for (int p = 0; p < int(group_.size()); ++p) {
      if (group_[p] != r) continue;
      const auto& part = parts_.regions[p];
      for (const auto v : part.mesh.vertices()) {
        if (!vertex.emplace(glued_.root(number(p, v)), int(soup.points.size())).second) continue;
        soup.points.push_back(part.mesh.point(v));
        region.curveParameter.push_back(part.curveParameter[v.idx()]);
        region.corner.push_back(part.corner[v.idx()]);
      }
      for (const auto f : part.mesh.faces()) {
        auto& corners = soup.triangles.emplace_back();
        int k = 0;
        for (const auto v : part.mesh.fv_range(f)) corners[k++] = vertex.at(glued_.root(number(p, v)));
      }
      region.inputTriangle.insert(region.inputTriangle.end(), part.inputTriangle.begin(),
                                  part.inputTriangle.end());
    }
    region.mesh = buildSurfaceMesh(soup);
    region.edgeCurve.resize(region.mesh.n_edges());
    const auto handle = [&](int p, VertexHandle v) {
      return VertexHandle(vertex.at(glued_.root(number(p, v))));
    };
    const auto edgeBetween = [&](VertexHandle a, VertexHandle b) {
      return region.mesh.edge_handle(region.mesh.find_halfedge(a, b));
    };
    for (int p = 0; p < int(group_.size()); ++p) {
      if (group_[p] != r) continue;
      const auto& part = parts_.regions[p];
      const auto edgeOf = [&](EdgeHandle e) {
        const auto h = part.mesh.halfedge_handle(e, 0);
        return edgeBetween(handle(p, part.mesh.from_vertex_handle(h)),
                           handle(p, part.mesh.to_vertex_handle(h)));
      };
      for (const auto e : part.mesh.edges())
        if (const auto curve = part.edgeCurve[e.idx()]; curve && !inner_[curve->index])
          region.edgeCurve[edgeOf(e).idx()] = curve_[curve->index];
      for (const auto e : part.aligned) region.aligned.push_back(edgeOf(e));
      for (const auto v : part.featurePoints) region.featurePoints.push_back(handle(p, v));
    }
    const auto tidy = [](auto& handles) {
      std::sort(handles.begin(), handles.end());
      handles.erase(std::unique(handles.begin(), handles.end()), handles.end());
    };
    tidy(region.aligned);
    tidy(region.featurePoints);
    for (const auto v : region.mesh.vertices())
      if (!region.mesh.is_boundary(v)) region.corner[v.idx()].reset(), region.curveParameter[v.idx()] = 0;
    model_.regions.push_back(std::move(region));
  }

  void addShells() {
    for (const auto& shell : parts_.shells) {
      auto& joined = model_.shells.emplace_back();
      joined.solid = shell.solid;
      for (const int p : shell.regions) joined.regions.push_back(group_[p]);
      std::sort(joined.regions.begin(), joined.regions.end());
      joined.regions.erase(std::unique(joined.regions.begin(), joined.regions.end()), joined.regions.end());
    }
  }

  const Model& parts_;
  const std::vector<char>& inner_;
  const std::vector<int> group_;
  std::vector<int> firstVertex_;  ///< by part
  DisjointSets glued_;            ///< of the vertices of all parts
  std::vector<CurveId> curve_;  ///< by curve of the parts: its new number
  Model model_;
};

}  // namespace

std::vector<int> joinedRegions(const Model& parts, const std::vector<char>& inner) {
  DisjointSets sets(parts.regions.size());
  std::vector<std::optional<int>> first(parts.curves.size());
  for (int p = 0; p < int(parts.regions.size()); ++p)
    for (const auto& curve : parts.regions[p].edgeCurve) {
      if (!curve || !inner[curve->index]) continue;
      auto& other = first[curve->index];
      if (other)
        sets.unite(*other, p);
      else
        other = p;
    }
  std::vector<int> joined(parts.regions.size());
  int count = 0;
  for (int p = 0; p < int(joined.size()); ++p) joined[p] = sets.root(p) == p ? count++ : joined[sets.root(p)];
  return joined;
}

Model joinRegions(const Model& parts, const std::vector<char>& inner,
                  const std::vector<std::shared_ptr<const TrueSurface>>& surfaces) {
  return RegionJoin(parts, inner).run(surfaces);
}

}  // namespace trimquad
