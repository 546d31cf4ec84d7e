#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "trimquad/tmesh/tmesh.h"

namespace trimquad {

/// Integer lengths of arcs, by arc.
using ArcLengths = std::vector<int>;

/// One of the two conditions of a patch: the first axis compares sides 0 and 2, the second sides 1 and 3.
struct EquationId {
  int index;
  friend auto operator<=>(EquationId, EquationId) = default;
  static EquationId of(PatchId patch, int axis) { return {2 * patch.index + axis}; }
  PatchId patch() const { return {index / 2}; }
  int axis() const { return index % 2; }
};

/// A T-mesh seen from its patches: which arcs occur where. Lengths are consistent if the sum of sign times
/// length is zero in every equation; an arc occurs in one or two, so they are a bidirected flow.
struct Dual {
  struct Term {
    ArcId arc;
    int sign;  ///< +1 on sides 0 and 1, -1 on sides 2 and 3
    int use;   ///< which of the arc's uses
  };
  struct Use {
    EquationId equation;
    int sign;
  };
  /// Where a half-arc stands in the loop of the patch to its left.
  struct Place {
    PatchId patch;
    int side;
    int index;  ///< in the side
  };

  explicit Dual(const TMesh& tmesh);

  const TMesh* tmesh;
  std::vector<std::vector<Term>> terms;       ///< by equation
  std::vector<std::vector<Use>> uses;         ///< by arc; one for border arcs
  std::vector<std::optional<Place>> place;    ///< by half-arc
  std::vector<std::vector<HalfArc>> leaving;  ///< by node

  const std::vector<Term>& operator[](EquationId id) const { return terms[id.index]; }
};

/// Total length of a side.
int lengthOf(const TMesh::Side& side, const ArcLengths& q);

/// Whether opposite sides of every patch are equally long and no length is negative.
bool isConsistent(const Dual& dual, const ArcLengths& q);

}  // namespace trimquad
