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

/// Finds ways through the insides of patches. A search costs what it meets, whatever the size of the mesh.
class PathSearch {
 public:
  PathSearch(const SurfaceMesh& input, RefinedMesh& refined, Occupied& occupied)
      : input_(input), refined_(refined), mesh_(refined.mesh), occupied_(occupied) {}

  /// The shortest way (in space) through the inside of a patch from one of its corners to another. Where no
  /// edges lead, it goes through edges and triangles, which are split. As the patch is a disk, the way is the
  /// only one up to deformations.
  EdgePath connect(PatchCorner from, PatchCorner to, int& splits);

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

  void start(PatchCorner from, PatchCorner to);
  std::vector<HalfedgeHandle> sector(PatchCorner corner) const;
  bool joined() const;
  std::vector<Stop> stops();
  Eigen::Vector3d place(const Stop& stop) const;
  void relax(std::optional<Stop> before, double distance, const Eigen::Vector3d& here, const Stop& next);
  void offer(std::optional<Stop> before, double distance, const Eigen::Vector3d& here, HalfedgeHandle h);
  void expand(const Stop& stop, double distance);
  bool touches(const Stop& stop, HalfedgeHandle h) const;
  Reached* reached(const Stop& stop);
  std::vector<Stop> way();

  const SurfaceMesh& input_;
  RefinedMesh& refined_;
  const SurfaceMesh& mesh_;
  Occupied& occupied_;
  VertexHandle from_, to_;
  Eigen::Vector3d goal_;
  std::vector<HalfedgeHandle> fromSector_, toSector_;
  std::vector<Reached> reached_;  ///< in this search
  std::array<std::vector<int>, 3>
      numbers_;                   ///< by kind and index: where in `reached_`, if it is there at all
  std::vector<Waiting> waiting_;  ///< a heap
};

}  // namespace trimquad
