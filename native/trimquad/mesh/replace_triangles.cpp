#include "trimquad/mesh/replace_triangles.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

class Replacement {
 public:
  Replacement(SurfaceMesh& mesh, const std::vector<TrianglePart>& parts, const std::vector<EdgeHandle>& cut)
      : mesh_(mesh), parts_(parts), cut_(cut), isCut_(mesh.n_edges(), false), sides_(parts.size()) {
    for (const EdgeHandle e : cut) isCut_[e.idx()] = true;
  }

  void run() {
    keepSides();
    loosen();
    joinSides();
    linkBoundary();
    setTriangles();
  }

 private:
  /// A side of a part that its triangle did not have.
  struct NewSide {
    VertexHandle low, high;
    bool upwards;
    HalfedgeHandle* halfedge;
    auto key() const { return std::pair(high, upwards); }
  };

  bool isCut(HalfedgeHandle h) const { return isCut_[mesh_.edge_handle(h).idx()]; }

  /// Sides that are not cut keep their halfedges.
  void keepSides() {
    for (std::size_t first = 0; first < parts_.size();) {
      std::size_t end = first;
      while (end < parts_.size() && parts_[end].whole == parts_[first].whole) ++end;
      std::array<HalfedgeHandle, 3> old;
      std::size_t count = 0;
      HalfedgeHandle h = mesh_.halfedge_handle(parts_[first].whole);
      for (int k = 0; k < 3; ++k, h = mesh_.next_halfedge_handle(h))
        if (!isCut(h)) old[count++] = h;
      for (std::size_t p = first; p < end; ++p)
        for (std::size_t k = 0; k < 3; ++k) {
          const VertexHandle from = parts_[p].corner[k], to = parts_[p].corner[(k + 1) % 3];
          for (std::size_t i = 0; i < count; ++i)
            if (mesh_.from_vertex_handle(old[i]) == from && mesh_.to_vertex_handle(old[i]) == to)
              sides_[p][k] = old[i];
          if (!sides_[p][k].is_valid())
            new_.push_back({std::min(from, to), std::max(from, to), from < to, &sides_[p][k]});
        }
      first = end;
    }
  }

  /// Lets go of the edges that are cut.
  void loosen() {
    for (const EdgeHandle e : cut_)
      for (const int k : {0, 1}) {
        const HalfedgeHandle h = mesh_.halfedge_handle(e, k);
        const VertexHandle v = mesh_.from_vertex_handle(h);
        if (mesh_.halfedge_handle(v).is_valid() && isCut(mesh_.halfedge_handle(v)))
          mesh_.set_halfedge_handle(v, HalfedgeHandle());
        if (!mesh_.is_boundary(h)) continue;
        if (!isCut(mesh_.next_halfedge_handle(h)))
          after_[mesh_.to_vertex_handle(h)] = mesh_.next_halfedge_handle(h);
        if (!isCut(mesh_.prev_halfedge_handle(h))) before_[v] = mesh_.prev_halfedge_handle(h);
      }
  }

  /// Edges for the new sides: those that were cut first.
  void joinSides() {
    sortNew();
    std::size_t reused = 0, edges = mesh_.n_edges();
    mesh_.resize(mesh_.n_vertices(), edges + distinctNew() - cut_.size(), mesh_.n_faces());
    for (std::size_t i = 0; i < new_.size();) {
      const auto& [low, high, upwards, halfedge] = new_[i];
      HalfedgeHandle up;
      if (reused < cut_.size()) {
        up = mesh_.halfedge_handle(cut_[reused++], 0);
      } else {
        up = mesh_.halfedge_handle(EdgeHandle(int(edges++)), 0);
      }
      const HalfedgeHandle down = mesh_.opposite_halfedge_handle(up);
      mesh_.set_vertex_handle(up, high);
      mesh_.set_vertex_handle(down, low);
      *halfedge = upwards ? up : down;
      const bool shared = i + 1 < new_.size() && new_[i + 1].low == low && new_[i + 1].high == high;
      if (shared) {
        TRIMQUAD_ASSERT(!upwards && new_[i + 1].upwards);
        *new_[i + 1].halfedge = up;
      } else {
        boundary_.push_back(upwards ? down : up);
      }
      i += shared ? 2 : 1;
    }
    TRIMQUAD_ASSERT(reused == cut_.size() && edges == mesh_.n_edges());
  }

  /// By their ends: into a bucket for each lower one, and there by the higher one.
  void sortNew() {
    std::vector<int> end(mesh_.n_vertices() + 1, 0);
    for (const NewSide& side : new_) ++end[side.low.idx() + 1];
    std::partial_sum(end.begin(), end.end(), end.begin());
    std::vector<NewSide> sorted(new_.size());
    for (const NewSide& side : new_) sorted[end[side.low.idx()]++] = side;
    for (std::size_t first = 0; first < sorted.size();) {
      const auto begin = sorted.begin() + long(first);
      first = std::size_t(end[begin->low.idx()]);
      std::sort(begin, sorted.begin() + long(first),
                [](const NewSide& a, const NewSide& b) { return a.key() < b.key(); });
    }
    new_.swap(sorted);
  }

  std::size_t distinctNew() const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < new_.size(); ++i)
      count += i == 0 || new_[i].low != new_[i - 1].low || new_[i].high != new_[i - 1].high;
    return count;
  }

  void linkBoundary() {
    std::map<VertexHandle, HalfedgeHandle> leaving;
    for (const HalfedgeHandle h : boundary_) leaving[mesh_.from_vertex_handle(h)] = h;
    for (const HalfedgeHandle h : boundary_) {
      mesh_.set_boundary(h);
      mesh_.set_halfedge_handle(mesh_.from_vertex_handle(h), h);
      const auto next = leaving.find(mesh_.to_vertex_handle(h));
      mesh_.set_next_halfedge_handle(
          h, next != leaving.end() ? next->second : after_.at(mesh_.to_vertex_handle(h)));
      const auto before = before_.find(mesh_.from_vertex_handle(h));
      if (before != before_.end()) mesh_.set_next_halfedge_handle(before->second, h);
    }
  }

  void setTriangles() {
    const auto isFirst = [&](std::size_t p) { return p == 0 || parts_[p - 1].whole != parts_[p].whole; };
    std::size_t faces = mesh_.n_faces(), added = 0;
    for (std::size_t p = 0; p < parts_.size(); ++p) added += !isFirst(p);
    mesh_.resize(mesh_.n_vertices(), mesh_.n_edges(), faces + added);
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      const FaceHandle f = isFirst(p) ? parts_[p].whole : FaceHandle(int(faces++));
      mesh_.set_halfedge_handle(f, sides_[p][0]);
      for (std::size_t k = 0; k < 3; ++k) {
        mesh_.set_face_handle(sides_[p][k], f);
        mesh_.set_next_halfedge_handle(sides_[p][k], sides_[p][(k + 1) % 3]);
        const VertexHandle v = parts_[p].corner[k];
        if (!mesh_.halfedge_handle(v).is_valid()) mesh_.set_halfedge_handle(v, sides_[p][k]);
      }
    }
  }

  SurfaceMesh& mesh_;
  const std::vector<TrianglePart>& parts_;
  const std::vector<EdgeHandle>& cut_;
  std::vector<bool> isCut_;                           ///< by edge that was there before
  std::vector<std::array<HalfedgeHandle, 3>> sides_;  ///< by part, from its corners
  std::vector<NewSide> new_;
  std::vector<HalfedgeHandle> boundary_;                   ///< the new ones without a triangle
  std::map<VertexHandle, HalfedgeHandle> before_, after_;  ///< along the boundary, next to what is cut
};

}  // namespace

void replaceTriangles(SurfaceMesh& mesh, const std::vector<TrianglePart>& parts,
                      const std::vector<EdgeHandle>& cut) {
  Replacement(mesh, parts, cut).run();
}

}  // namespace trimquad
