#pragma once

#include <array>
#include <compare>
#include <optional>
#include <vector>

#include "trimquad/tmesh/surface_point.h"

namespace trimquad {

struct NodeId {
  int index;
  friend auto operator<=>(NodeId, NodeId) = default;
};
struct ArcId {
  int index;
  friend auto operator<=>(ArcId, ArcId) = default;
};
struct PatchId {
  int index;
  friend auto operator<=>(PatchId, PatchId) = default;
};

/// An arc with a direction in which it is walked.
struct HalfArc {
  ArcId arc;
  bool forward;

  int index() const { return 2 * arc.index + !forward; }  ///< numbers all half-arcs from 0
  static HalfArc at(int index) { return {ArcId{index / 2}, index % 2 == 0}; }
  HalfArc opposite() const { return {arc, !forward}; }
  friend bool operator==(HalfArc, HalfArc) = default;
};

/// A partition of a mapped surface into patches that are rectangles of the map: the free-boundary motorcycle
/// graph, completed by virtual arcs where the surface's boundary cuts a rectangle (paper, section 4). An arc
/// may bound one patch on both sides, or be a loop. All lengths are exact numbers of quanta.
struct TMesh {
  enum class NodeKind {
    Singular,  ///< a singularity of the map
    Feature,  ///< a feature point; a corner, an end or a junction of aligned curves, or one on a closed curve
    Boundary,   ///< an arc ends on the surface's boundary
    Regular,    ///< four arcs meet inside the surface
    TJunction,  ///< three do
    Virtual     ///< corner of a completed rectangle, beyond the surface's boundary
  };
  struct Node {
    NodeKind kind;
    bool critical;                      ///< must lie on a grid point of its own: Singular and Feature
    bool border;                        ///< on the boundary of the surface, or virtual
    std::optional<SurfacePoint> place;  ///< none for virtual nodes
    Eigen::Vector3d
        position;  ///< model units; for a virtual node of the point of the boundary nearest in the map
  };
  /// A straight piece of an arc: through a triangle, or along an edge.
  struct Leg {
    HalfedgeHandle
        side;  ///< of the triangle in whose chart the numbers hold; the edge itself where it runs along one
    bool alongEdge;
    int direction;    ///< quarter turns from +u
    Quanta constant;  ///< v for directions 0 and 2, u for 1 and 3
    SurfacePoint from, to;
  };
  struct Arc {
    NodeId from, to;
    Quanta length;  ///< target length: of the arc in the map; of a virtual arc in the smallest completing
                    ///< rectangle
    bool isVirtual;
    bool border;            ///< one patch only: along an aligned boundary, or virtual
    bool critical;          ///< along an aligned edge
    std::vector<Leg> legs;  ///< from `from` to `to`, each starting where the one before ends; none if virtual
  };
  using Side = std::vector<HalfArc>;
  struct Patch {
    std::array<Side, 4> sides;  ///< counter-clockwise; consecutive sides turn left by 90 degrees
    int type;                   ///< 1 .. 13, see `patchType`
  };
  /// A free piece of the surface's boundary between two arcs that end there; it cuts 1 to 4 corners off a
  /// patch.
  struct RedSegment {
    PatchId patch;
    std::vector<HalfArc> virtualArcs;  ///< that complete the patch: one more than corners that are cut off
    std::vector<HalfedgeHandle>
        edges;  ///< surface to their left, from the one that starts it to the one that ends it
  };

  FixedScale scale;
  std::vector<Node> nodes;
  std::vector<Arc> arcs;
  std::vector<Patch> patches;
  std::vector<RedSegment> redSegments;

  const Node& operator[](NodeId id) const { return nodes[id.index]; }
  const Arc& operator[](ArcId id) const { return arcs[id.index]; }
  const Patch& operator[](PatchId id) const { return patches[id.index]; }
  NodeId start(HalfArc h) const { return h.forward ? arcs[h.arc.index].from : arcs[h.arc.index].to; }
  NodeId end(HalfArc h) const { return start(h.opposite()); }
  Quanta length(const TMesh::Side& side) const;
};

/// Which of the 13 configurations of the paper's Fig. 5 a patch is, up to symmetry, by its sides without any
/// real arc and its corners that are cut off. All four sides there: 1 no corner cut, 2 one, 3 two adjacent, 4
/// two opposite, 5 three, 6 four. One side missing: 7 no further corner cut, 8 one, 9 two. 10 two opposite
/// sides missing. Two adjacent sides missing: 11 no further corner cut, 12 one. 13 three sides missing.
int patchType(const TMesh& tmesh, const std::array<TMesh::Side, 4>& sides);

/// Throws where something does not hold that every T-mesh promises: closed loops of four sides, opposite
/// sides of equal length, every arc on two patches in opposite directions or on one if it is border, V - E +
/// F as of the surface.
void verify(const TMesh& tmesh, int eulerCharacteristic);

}  // namespace trimquad
