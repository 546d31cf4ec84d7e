#pragma once

#include <optional>
#include <vector>

#include "trimquad/quantize/dual.h"

namespace trimquad {

/// Which parts of a surface's boundary must be apart.
enum class Separation {
  Free,   ///< paper, section 5.2.1: boundary parts may coincide where a zero piece of the boundary joins them
  Strong  ///< paper, Definition 5.1: no two nodes of virtual arcs coincide. Needlessly strict, for comparison
};

/// Why lengths admit no integer grid map. It stays so as long as all arcs named keep their lengths and those
/// of `mightVanish` do not vanish, whatever the others do.
struct Collapse {
  std::vector<ArcId> zeroArcs;  ///< that are collapsed onto one point or line
  std::vector<ArcId>
      mightVanish;            ///< a zero piece of boundary could begin with one of them and make it right
  std::vector<ArcId> others;  ///< whose lengths say what else is collapsed
};

/// Tests consistent lengths for separation. A patch of zero width is mapped onto a line and a zero arc onto a
/// point, so each grid point is the image of a set of nodes, arc points, zero arcs and lines across zero
/// patches, and each unit piece of a grid line the image of a chain of such pieces. A grid map that is
/// injective exists if and only if all these sets can shrink to a point (or line) on the surface without
/// changing it: each is contractible, holds one critical node at most, and meets the boundary and the aligned
/// curves in one connected, simple piece at most. This is the paper's test (sections 5.2 and 5.2.1) taken
/// through all chains of coincidences; it also finds zero loops around handles and pieces of boundary that
/// fold onto each other, which paths between nodes do not show.
class SeparationTest {
 public:
  SeparationTest(const Dual& dual, Separation separation);

  /// The first fault, or none.
  std::optional<Collapse> fault(const ArcLengths& q) const;

  /// All of them, each with arcs of its own class.
  std::vector<Collapse> faults(const ArcLengths& q) const;

  /// Whether the arc has length one at least in all separating lengths, by what its two ends are.
  bool mustNotVanish(ArcId arc) const;

  /// The same as without `touched`, where lengths without fault were changed in `touched` arcs only; as
  /// costly as what lies near them.
  std::optional<Collapse> fault(const ArcLengths& q, const std::vector<ArcId>& touched) const;

 private:
  std::vector<ArcId> allArcs() const;
  std::vector<Collapse> search(const ArcLengths& q, const std::vector<ArcId>& touched,
                               std::size_t most) const;

  const Dual& dual_;
  const TMesh& tmesh_;
  std::vector<bool> isCritical_;  ///< by node
  std::vector<bool> onCurve_;     ///< by node: on the boundary or an aligned curve
};

}  // namespace trimquad
