#include "trimquad/embed/zero_index.h"

#include <algorithm>

namespace trimquad {

ZeroIndex::ZeroIndex(const EmbeddedTMesh& embedded) : embedded_(embedded) {
  for (std::size_t a = 0; a < embedded.arcs.size(); ++a) touch(ArcId{int(a)});
  for (std::size_t p = 0; p < embedded.patches.size(); ++p) touch(PatchId{int(p)});
  update();
}

void ZeroIndex::update() {
  for (const ArcId a : touchedArcs_) {
    const auto& arc = embedded_[a];
    for (const bool onCurve : {false, true})
      if (!arc.removed && arc.length == 0 && arc.onCurve == onCurve)
        arcs_[onCurve].insert(a);
      else
        arcs_[onCurve].erase(a);
  }
  length_.resize(embedded_.patches.size(), 0);
  for (const PatchId p : touchedPatches_) {
    const auto& patch = embedded_[p];
    const int a = embedded_.length(patch.sides[0]), b = embedded_.length(patch.sides[1]);
    const bool isZero = !patch.removed && (a == 0 || b == 0);
    const int length = isZero ? std::max(a, b) : 0;
    totalLength_ += length - length_[p.index];
    longer_ += (length > 0) - (length_[p.index] > 0);
    length_[p.index] = length;
    std::size_t arcs = 0;
    for (const auto& side : patch.sides) arcs += side.size();
    isZero ? void(patches_.insert(p)) : void(patches_.erase(p));
    isZero&& arcs <= 2 ? void(closable_.insert(p)) : void(closable_.erase(p));
  }
  touchedArcs_.clear();
  touchedPatches_.clear();
}

ZeroIndex::Potential ZeroIndex::potential() const {
  return {totalLength_, -longer_, long(arcs_[0].size() + arcs_[1].size())};
}

}  // namespace trimquad
