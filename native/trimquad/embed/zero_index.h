#pragma once

#include <optional>
#include <set>
#include <tuple>
#include <vector>

#include "trimquad/embed/embedded_tmesh.h"

namespace trimquad {

/// What of an embedded T-mesh has length zero, kept while it changes.
class ZeroIndex {
 public:
  /// What every operator makes smaller, in this order: total length of the zero patches; minus the number of
  /// those longer than zero; number of zero arcs.
  using Potential = std::tuple<long, long, long>;

  explicit ZeroIndex(const EmbeddedTMesh& embedded);

  /// The arc or the loop of the patch is not what it was.
  void touch(ArcId a) { touchedArcs_.push_back(a); }
  void touch(PatchId p) { touchedPatches_.push_back(p); }
  /// Looks at what was touched anew.
  void update();

  Potential potential() const;
  const std::set<ArcId>& arcs(bool onCurve) const { return arcs_[onCurve]; }  ///< of length zero
  const std::set<PatchId>& patches() const { return patches_; }               ///< with a side of length zero
  const std::set<PatchId>& closable() const { return closable_; }  ///< of these, bounded by one or two arcs

 private:
  const EmbeddedTMesh& embedded_;
  std::vector<ArcId> touchedArcs_;
  std::vector<PatchId> touchedPatches_;
  std::set<ArcId> arcs_[2];
  std::set<PatchId> patches_, closable_;
  std::vector<int> length_;  ///< by patch: of the zero patches' longer sides
  long totalLength_ = 0, longer_ = 0;
};

}  // namespace trimquad
