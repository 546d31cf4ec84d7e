#include "trimquad/tmesh/tmesh.h"

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

void verifyLoop(const TMesh& tmesh, const TMesh::Patch& patch) {
  std::vector<HalfArc> loop;
  for (const auto& side : patch.sides) {
    TRIMQUAD_ASSERT(!side.empty());
    loop.insert(loop.end(), side.begin(), side.end());
  }
  for (std::size_t k = 0; k < loop.size(); ++k)
    TRIMQUAD_ASSERT(tmesh.end(loop[k]) == tmesh.start(loop[(k + 1) % loop.size()]));
  TRIMQUAD_ASSERT(tmesh.length(patch.sides[0]) == tmesh.length(patch.sides[2]));
  TRIMQUAD_ASSERT(tmesh.length(patch.sides[1]) == tmesh.length(patch.sides[3]));
}

}  // namespace

Quanta TMesh::length(const Side& side) const {
  Quanta sum = 0;
  for (const HalfArc h : side) sum += (*this)[h.arc].length;
  return sum;
}

int patchType(const TMesh& tmesh, const std::array<TMesh::Side, 4>& sides) {
  bool missing[4], cut[4];
  int missingCount = 0, cutCount = 0;
  for (int k = 0; k < 4; ++k) {
    missing[k] = true;
    for (const HalfArc h : sides[k]) missing[k] = missing[k] && tmesh[h.arc].isVirtual;
    cut[k] = tmesh[sides[k].back().arc].isVirtual;
    missingCount += missing[k], cutCount += cut[k];
  }
  switch (missingCount) {
    case 0:
      if (cutCount < 2) return 1 + cutCount;
      if (cutCount == 2) return cut[0] == cut[2] ? 4 : 3;
      return 2 + cutCount;
    case 1:
      return 5 + cutCount;
    case 2:
      if (missing[0] == missing[2]) return 10;
      return 8 + cutCount;
    default:
      TRIMQUAD_ASSERT(missingCount == 3);
      return 13;
  }
}

void verify(const TMesh& tmesh, int eulerCharacteristic) {
  std::vector<int> uses(2 * tmesh.arcs.size(), 0);
  for (const auto& patch : tmesh.patches) {
    verifyLoop(tmesh, patch);
    for (const auto& side : patch.sides)
      for (const HalfArc h : side) ++uses[h.index()];
  }
  for (std::size_t a = 0; a < tmesh.arcs.size(); ++a) {
    TRIMQUAD_ASSERT(uses[2 * a] <= 1 && uses[2 * a + 1] <= 1);
    TRIMQUAD_ASSERT(uses[2 * a] + uses[2 * a + 1] == (tmesh.arcs[a].border ? 1 : 2));
    TRIMQUAD_ASSERT(tmesh.arcs[a].length >= 0);
  }
  TRIMQUAD_ASSERT(int(tmesh.nodes.size()) - int(tmesh.arcs.size()) + int(tmesh.patches.size()) ==
                  eulerCharacteristic);
}

}  // namespace trimquad
