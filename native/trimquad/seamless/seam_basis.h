#pragma once

#include <optional>
#include <vector>

#include "trimquad/base/constraint_basis.h"
#include "trimquad/base/fixed.h"
#include "trimquad/field/cross_field.h"
#include "trimquad/seamless/seam_graph.h"

namespace trimquad {

/// Whole quads, per axis; free where there is none.
using BranchTranslation = std::array<std::optional<int>, 2>;

/// An edge of a triangle that must run along a grid line: both its ends have the same coordinate `axis` in
/// the triangle's chart.
struct AlignedSide {
  HalfedgeHandle side;
  int axis;
};

/// How coordinates change along a path over the surface: x -> rotated(x, rotation) + sum of rotated branch
/// translations + offset.
struct PathTransition {
  struct Term {
    int branch, rotation, factor;
  };
  int rotation = 0;         ///< quarter turns
  std::vector<Term> terms;  ///< factor * rotated(translation of branch, rotation)
  FixedVector offset;       ///< whole quads

  void cross(const SeamGraph& seams, const SeamGraph::Crossing& crossing);
  void move(FixedVector wholeQuads) { offset = offset + wholeQuads; }
};

/// Points at whole-number distances from each other, with two coordinates each, some of them vertices of the
/// mesh. They hold the map to the grid.
struct GridPoints {
  struct Relation {
    int from, to;
    PathTransition path;
  };
  struct Place {
    int point;
    HalfedgeHandle corner;  ///< the point is the vertex that this leaves, in the chart of its triangle
  };
  int count = 0;
  std::vector<Relation> relations;
  std::vector<Place> places;
};

struct SeamConstraints {
  std::vector<BranchTranslation> translations;  ///< by branch; none fixed where empty
  std::vector<AlignedSide> aligned;
  GridPoints grid;
};

/// The map's unknowns: translations of the branches, then one point per vertex and sector between seams
/// ("wedge"), constrained to be seamless, then the grid points.
class SeamBasis {
 public:
  /// Without grid points that are vertices the first wedge is held at the origin, else the first grid point.
  /// Throws Error(Stage) where whole numbers contradict each other.
  SeamBasis(const SurfaceMesh& mesh, const SeamGraph& seams, const SeamConstraints& constraints);

  int wedge(HalfedgeHandle h) const { return wedge_[h.idx()]; }  ///< of the vertex that h leaves, in h's face
  int wedgeCount() const { return wedgeCount_; }
  int branchCount() const { return branches_; }
  /// Index in x of a wedge's or branch's coordinate.
  int coordinate(int wedge, int axis) const { return 2 * branches_ + 2 * wedge + axis; }
  int translation(int branch, int axis) const { return 2 * branch + axis; }
  int gridPoint(int point, int axis) const { return 2 * branches_ + 2 * wedgeCount_ + 2 * point + axis; }
  const ConstraintBasis& basis() const { return basis_; }

 private:
  void holdGauge(const GridPoints& grid);
  void addGridPoints(const SurfaceMesh& mesh, const GridPoints& grid);
  void addSeams(const SurfaceMesh& mesh, const SeamGraph& seams);

  int branches_;
  int wedgeCount_ = 0;
  std::vector<int> wedge_;
  ConstraintBasis basis_;
};

}  // namespace trimquad
