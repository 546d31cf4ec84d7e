#pragma once

#include <array>
#include <compare>
#include <optional>
#include <tuple>
#include <vector>

#include "trimquad/embed/insert_arcs.h"

namespace trimquad {

/// Which vertices and edges of a mesh the arcs of a T-mesh run through.
struct Occupied {
  std::vector<bool> vertex, edge;  ///< by index

  void grow(const SurfaceMesh& mesh) {
    vertex.resize(mesh.n_vertices(), false);
    edge.resize(mesh.n_edges(), false);
  }
};

/// A corner of a patch: the two halfedges of its loop that meet there, the patch to their left.
struct PatchCorner {
  HalfedgeHandle in, out;
};

/// A corner of a patch where a way may end, and how far it is from there on along its loop, which counts as
/// well (model units).
struct Landing {
  PatchCorner corner;
  double onward = 0;
};

/// Finds ways through the insides of patches. A search costs what it meets, whatever the size of the mesh.
class PathSearch {
 public:
  PathSearch(const SurfaceMesh& input, RefinedMesh& refined, Occupied& occupied)
      : input_(input), refined_(refined), mesh_(refined.mesh), occupied_(occupied) {}

  struct Way {
    EdgePath path;        ///< the corners' vertices included
    std::size_t landing;  ///< where it ends
  };

  /// The shortest way (in space) through the inside of a patch from one of its corners to one of the
  /// landings. Where no edges lead, it goes through edges and triangles, which are split. As the patch is a
  /// disk, the way is the only one up to deformations.
  /// \param landings  of different vertices; the last one has nothing more to go, and the others go there
  Way connect(PatchCorner from, const std::vector<Landing>& landings, int& splits);

 private:
  /// A vertex, or the middle of an edge or triangle that would have to be split. An edge is a stop on the way
  /// out of the triangle of its halfedge: once it is split, the triangle's other sides are apart.
  struct Stop {
    enum Kind { Vertex, Side, Triangle } kind;
    int index;
    friend auto operator<=>(const Stop&, const Stop&) = default;
  };
  struct Reached {
    Stop stop;
    double distance;
    std::optional<Stop> before;
  };
  /// Least possible length of a way through the stop, its distance from the start, the stop (A*).
  using Waiting = std::tuple<double, double, Stop>;

  static Stop stopAt(VertexHandle v) { return {Stop::Vertex, v.idx()}; }
  static Stop stopAt(HalfedgeHandle h) { return {Stop::Side, h.idx()}; }
  static Stop stopAt(FaceHandle f) { return {Stop::Triangle, f.idx()}; }

  void start(PatchCorner from, const std::vector<Landing>& landings);
  std::vector<HalfedgeHandle> sector(PatchCorner corner) const;
  std::vector<Stop> search();
  Eigen::Vector3d place(const Stop& stop) const;
  void relax(std::optional<Stop> before, double distance, const Eigen::Vector3d& here, const Stop& next);
  void offer(std::optional<Stop> before, double distance, const Eigen::Vector3d& here, HalfedgeHandle h);
  void offerVertex(std::optional<Stop> before, double distance, const Eigen::Vector3d& here,
                   HalfedgeHandle h);
  void offerThroughTriangle(HalfedgeHandle h);
  void expand(const Stop& stop, double distance);
  std::optional<std::size_t> landingAt(HalfedgeHandle h) const;
  std::optional<std::size_t> landingOf(const Stop& stop) const;
  Reached* reached(const Stop& stop);
  std::vector<Stop> wayTo(const Stop& stop);

  const SurfaceMesh& input_;
  RefinedMesh& refined_;
  const SurfaceMesh& mesh_;
  Occupied& occupied_;
  VertexHandle from_;
  std::vector<Landing> landings_;
  std::vector<std::size_t> landingNumbers_;  ///< by vertex: where in `landings_`, if it is there at all
  Eigen::Vector3d goal_;                     ///< of the last landing
  std::vector<Reached> reached_;             ///< in this search
  std::array<std::vector<int>, 3>
      numbers_;                   ///< by kind and index: where in `reached_`, if it is there at all
  std::vector<Waiting> waiting_;  ///< a heap
};

}  // namespace trimquad
