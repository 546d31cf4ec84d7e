#pragma once

#include <array>
#include <vector>

#include "trimquad/embed/insert_arcs.h"

namespace trimquad {

/// A T-mesh whose arcs, virtual ones too, run along edges of a mesh and whose nodes are vertices; each patch
/// is a disk of triangles. (Paper, section 6.1)
struct EmbeddedTMesh {
  struct Node {
    VertexHandle vertex;
    bool critical;
    bool onCurve;  ///< on the boundary of the surface or an aligned curve
    bool removed = false;
  };
  struct Arc {
    NodeId from, to;
    int length;    ///< quads
    bool border;   ///< along the boundary of the surface: one patch only
    bool onCurve;  ///< along the boundary or an aligned curve, which it must not leave
    EdgePath path;
    bool removed = false;
  };
  using Side = std::vector<HalfArc>;
  struct Patch {
    std::array<Side, 4> sides;  ///< counter-clockwise; may be empty while zero arcs are being collapsed
    bool removed = false;
  };
  /// What it took.
  struct Counters {
    int crossings = 0;         ///< vertices that the exact arcs have and the mesh has not
    int snapped = 0;           ///< of these, moved to vertices of the mesh
    int splits = 0;            ///< edges and triangles split afterwards
    int inserted = 0;          ///< vertices of the result that the input has not
    int zeroArcCollapses = 0;  ///< paper's operator 1
    int patchSplits = 0;       ///< operator 2
    int patchCollapses = 0;    ///< operator 3
  };

  RefinedMesh surface;
  std::vector<Node> nodes;
  std::vector<Arc> arcs;
  std::vector<Patch> patches;
  std::vector<NodeId> nodeOf;  ///< by node of the T-mesh: where it came to lie
  Counters counters;

  const Node& operator[](NodeId id) const { return nodes[id.index]; }
  const Arc& operator[](ArcId id) const { return arcs[id.index]; }
  const Patch& operator[](PatchId id) const { return patches[id.index]; }
  NodeId start(HalfArc h) const { return h.forward ? arcs[h.arc.index].from : arcs[h.arc.index].to; }
  NodeId end(HalfArc h) const { return start(h.opposite()); }
  /// Vertices in the direction of the half-arc.
  EdgePath path(HalfArc h) const;
  /// The mesh's halfedges in the direction of the half-arc, its patch to their left.
  std::vector<HalfedgeHandle> halfedges(HalfArc h) const;
  std::vector<HalfArc> loop(PatchId id) const;  ///< all four sides
  int length(const Side& side) const;
};

/// Throws where something does not hold that every embedding of a connected surface promises, also between
/// operators: arcs meet only in nodes; each patch is a disk with its loop around it; patches cover the
/// surface; border arcs cover its boundary; opposite sides are equally long. What is removed does not count.
/// As costly as the arcs are long, and a count of the mesh's elements.
void verify(const EmbeddedTMesh& embedded);

}  // namespace trimquad
