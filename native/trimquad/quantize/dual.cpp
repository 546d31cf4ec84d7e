#include "trimquad/quantize/dual.h"

#include <algorithm>

namespace trimquad {

Dual::Dual(const TMesh& t)
    : tmesh(&t),
      terms(2 * t.patches.size()),
      uses(t.arcs.size()),
      place(2 * t.arcs.size()),
      leaving(t.nodes.size()) {
  for (std::size_t p = 0; p < t.patches.size(); ++p)
    for (int side = 0; side < 4; ++side) {
      const TMesh::Side& arcs = t.patches[p].sides[side];
      const EquationId equation = EquationId::of(PatchId{int(p)}, side % 2);
      const int sign = side < 2 ? 1 : -1;
      for (std::size_t k = 0; k < arcs.size(); ++k) {
        place[arcs[k].index()] = Place{PatchId{int(p)}, side, int(k)};
        auto& arcUses = uses[arcs[k].arc.index];
        terms[equation.index].push_back({arcs[k].arc, sign, int(arcUses.size())});
        arcUses.push_back({equation, sign});
      }
    }
  for (std::size_t a = 0; a < t.arcs.size(); ++a)
    for (const bool forward : {true, false}) {
      const HalfArc h{ArcId{int(a)}, forward};
      leaving[t.start(h).index].push_back(h);
    }
}

int lengthOf(const TMesh::Side& side, const ArcLengths& q) {
  int sum = 0;
  for (const HalfArc h : side) sum += q[h.arc.index];
  return sum;
}

bool isConsistent(const Dual& dual, const ArcLengths& q) {
  if (std::any_of(q.begin(), q.end(), [](int x) { return x < 0; })) return false;
  return std::all_of(dual.terms.begin(), dual.terms.end(), [&](const auto& equation) {
    int sum = 0;
    for (const Dual::Term& term : equation) sum += term.sign * q[term.arc.index];
    return sum == 0;
  });
}

}  // namespace trimquad
