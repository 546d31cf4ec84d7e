#include "trimquad/quantize/quantize.h"
#include "support/rounds.h"

#include <cmath>

#include "quotient.h"
#include "support/random_surfaces.h"
#include "support/tmesh_checks.h"
#include "trimquad/quantize/circuits.h"
#include "trimquad/quantize/greedy.h"
#include "trimquad/quantize/neighbourhoods.h"
#include "trimquad/quantize/short_loops.h"

using namespace trimquad;
using namespace trimquad::samples;

namespace {

/// A random map, in quads from much larger than the surface to much smaller: the same map in another unit.
GridMap randomMap(unsigned seed, bool curves) {
  std::mt19937 random(seed);
  GridMap map = random() % 2 == 0 ? randomDomain(random) : randomSingularSurface(random);
  if (curves && random() % 2 == 0) alignSome(map, 1 + random() % 4, random);
  if (random() % 3 == 0) markSome(map, 2 + random() % 20, random);
  map.scale.bits += int(random() % 9) - 4;
  return map;
}

bool isSoundQuotient(const GridMap& map, const TMesh& tmesh, const ArcLengths& q) {
  return QuotientSurface(tmesh, q).isSound(eulerCharacteristic(map.mesh),
                                           int(boundaryLoops(map.mesh).size()));
}

/// Least objective over all separating lengths under `limit`, by trying all; infinite if there is none.
class Exhaustive {
 public:
  Exhaustive(const Dual& dual, const Objective& objective, const SeparationTest& separation, double limit)
      : dual_(dual), objective_(objective), separation_(separation), best_(limit), q_(dual.uses.size(), 0) {
    std::vector<std::size_t> last(dual.terms.size(), 0);
    for (std::size_t e = 0; e < dual.terms.size(); ++e)
      for (const auto& term : dual.terms[e]) last[e] = std::max(last[e], std::size_t(term.arc.index));
    closing_.resize(q_.size());
    for (std::size_t e = 0; e < last.size(); ++e) closing_[last[e]].push_back(EquationId{int(e)});
    try_(0, 0);
  }

  double best() const { return best_; }

 private:
  void try_(std::size_t a, double cost) {
    if (a == q_.size()) {
      if (!separation_.fault(q_)) best_ = cost;
      return;
    }
    // Outwards from the target.
    const int middle = std::max(0, int(std::lround(objective_.target[a])));
    for (const int step : {1, -1})
      for (q_[a] = middle + (step < 0 ? -1 : 0); q_[a] >= 0; q_[a] += step) {
        const double next = cost + objective_.of({int(a)}, q_[a]);
        if (next >= best_ - 1e-9) break;
        if (balanced(a)) try_(a + 1, next);
      }
  }

  bool balanced(std::size_t a) const {
    for (const EquationId e : closing_[a]) {
      int sum = 0;
      for (const auto& term : dual_[e]) sum += term.sign * q_[term.arc.index];
      if (sum != 0) return false;
    }
    return true;
  }

  const Dual& dual_;
  const Objective& objective_;
  const SeparationTest& separation_;
  double best_;
  ArcLengths q_;
  std::vector<std::vector<EquationId>> closing_;  ///< by arc: equations that are complete with it
};

/// A tall domain with notches on both sides in turn, `step` apart, so that as many lines cross it; blocks at
/// its ends.
GridMap notchedColumn(int notches, double step) {
  const int rows = notches + 5;
  return planarMap(sheet(6, rows,
                         [&](int i, int j) -> Eigen::Vector2d {
                           const int notch = j - 2;
                           double left = -3, right = 3;
                           if (notch >= 0 && notch < notches) (notch % 2 == 0 ? left : right) *= 0.98;
                           const double y = j < 2             ? 2.0 * (j - 2) - 0.1 * step
                                            : j > 2 + notches ? notches * step + 2.0 * (j - 2 - notches)
                                                              : notch * step;
                           return {left + (right - left) * i / 6, y};
                         }),
                   30);
}

/// Lengths without short loops are better than the widened ones they were searched from, or these.
void expectNoWorseThanWidened(const TMesh& tmesh, ArcLengths q, const Quantization& found) {
  const Dual dual(tmesh);
  const Objective objective(tmesh, QuantizationOptions().virtualWeight);
  widenLoops(dual, objective, SeparationTest(dual, Separation::Free), q, Progress());
  EXPECT_LE(found.objective, objective(q) + 1e-9);
}

}  // namespace

TEST(Separation, isWhatMakesTheQuotientTheSameSurface) {
  // Random consistent lengths with many zeros: multiples of circuits added to zero.
  const Progress progress;
  int sound = 0, unsound = 0;
  for (unsigned seed = 0; seed < sample::rounds(200) && !testing::Test::HasFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const GridMap map = randomMap(seed, false);
    const TMesh tmesh = partition(map, progress);
    if (tmesh.arcs.size() > 150) continue;
    const Dual dual(tmesh);
    const SeparationTest separation(dual, Separation::Free);
    CircuitSearch circuits(dual);
    std::mt19937 random(seed);
    std::vector<double> price(tmesh.arcs.size());
    ArcLengths q(tmesh.arcs.size(), 0);
    for (int k = 0; k < 60; ++k) {
      for (double& p : price) p = 1 + random() % 50;
      const auto circuit =
          circuits.through({int(random() % q.size())}, 1, [&](ArcId a, int change, int already) {
            return q[a.index] + already + change < 0 ? std::numeric_limits<double>::infinity()
                                                     : price[a.index];
          });
      if (circuit)
        for (const auto& s : circuit->steps) q[s.arc.index] += s.change;
      ASSERT_TRUE(isConsistent(dual, q));
      const bool expected = isSoundQuotient(map, tmesh, q);
      EXPECT_EQ(!separation.fault(q), expected) << "after " << k << " circuits";
      (expected ? sound : unsound) += 1;
    }
  }
  EXPECT_GT(sound, int(sample::rounds(300)));
  EXPECT_GT(unsound, int(sample::rounds(300)));
}

TEST(Quantize, randomSurfacesGetConsistentSeparatingLengths) {
  const Progress progress;
  for (unsigned seed = 0; seed < sample::rounds(100) && !testing::Test::HasFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const GridMap map = randomMap(seed, true);
    const TMesh tmesh = partition(map, progress);
    const Dual dual(tmesh);
    const ArcLengths positive = positiveLengths(dual, Objective(tmesh, 0.1), progress);
    EXPECT_TRUE(isConsistent(dual, positive));
    EXPECT_GE(*std::min_element(positive.begin(), positive.end()), 1);
    const Quantization result = quantize(tmesh, {}, progress);
    EXPECT_TRUE(isConsistent(dual, result.length));
    EXPECT_TRUE(isSoundQuotient(map, tmesh, result.length));
    QuantizationOptions strong;
    strong.separation = Separation::Strong;
    EXPECT_TRUE(isSoundQuotient(map, tmesh, quantize(tmesh, strong, progress).length));
  }
}

TEST(Quantize, targetsThatAreWholeAreKept) {
  const Progress progress;
  for (const int quarters : {3, 5, 6}) {
    const GridMap map = gridMapOf(cone(quarters, 6, 3), 30);
    EXPECT_EQ(quantize(partition(map, progress), {}, progress).objective, 0);
  }
  const GridMap torus = gridMapOf(wrapped(12, 8, 0.5, 0.5, true), 30);
  EXPECT_EQ(quantize(partition(torus, progress), {}, progress).objective, 0);
}

TEST(Quantize, aTorusFarSmallerThanAQuadKeepsBothItsHandles) {
  const Progress progress;
  const GridMap torus = gridMapOf(wrapped(12, 8, 0.001, 0.001, true), 30);
  const Quantization q = quantize(partition(torus, progress), {}, progress);
  EXPECT_EQ(q.zeroArcs, 0);
}

TEST(Quantize, noTwoEdgesOfTheGridJoinTheSamePoints) {
  const Progress progress;
  int narrow = 0;
  for (unsigned seed = 0; seed < sample::rounds(100) && !testing::Test::HasFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const GridMap map = randomMap(seed, true);
    const auto quads = coneQuarters(map);
    bool singleQuad = false;
    for (const auto v : map.mesh.vertices())
      singleQuad = singleQuad || (!map.mesh.is_boundary(v) && quads[v.idx()] == 1);
    if (singleQuad) continue;
    const TMesh tmesh = partition(map, progress);
    QuantizationOptions as;
    as.widen = false;
    const ArcLengths before = quantize(tmesh, as, progress).length;
    const Quantization after = quantize(tmesh, {}, progress);
    EXPECT_FALSE(hasShortLoops(tmesh, after.length));
    EXPECT_EQ(after.widened > 0, hasShortLoops(tmesh, before));
    EXPECT_TRUE(isSoundQuotient(map, tmesh, after.length));
    if (after.widened > 0) expectNoWorseThanWidened(tmesh, before, after);
    narrow += after.widened > 0;
  }
  EXPECT_GE(narrow, int(sample::rounds(100) / 100));  // few inputs may have none
}

TEST(Quantize, aTorusHasThreeQuadsAroundAtLeast) {
  const Progress progress;
  const GridMap torus = gridMapOf(wrapped(12, 8, 0.001, 0.5, true), 30);
  const TMesh tmesh = partition(torus, progress);
  const Quantization q = quantize(tmesh, {}, progress);
  EXPECT_FALSE(hasShortLoops(tmesh, q.length));
  long quads = 0;
  for (const auto& patch : tmesh.patches)
    quads += long(lengthOf(patch.sides[0], q.length)) * lengthOf(patch.sides[1], q.length);
  EXPECT_EQ(quads, 3 * 4);  // half a quad wide, 8 columns of them
}

TEST(Quantize, aThinColumnMayLoseItsHeightBetweenNotches) {
  const Progress progress;
  constexpr int kNotches = 8;
  const GridMap map = notchedColumn(kNotches, 0.01);
  const TMesh tmesh = partition(map, progress);
  // The height between the first and the last notch: that of the zero side of patches with two real arcs
  // across.
  const auto height = [&](Separation separation) {
    QuantizationOptions options;
    options.separation = separation;
    const ArcLengths q = quantize(tmesh, options, progress).length;
    int sum = 0, count = 0;
    for (const auto& patch : tmesh.patches)
      if (patch.type == 10)
        for (int side = 0; side < 4; ++side)
          if (std::any_of(patch.sides[side].begin(), patch.sides[side].end(),
                          [&](HalfArc h) { return !tmesh[h.arc].isVirtual; })) {
            sum += lengthOf(patch.sides[(side + 1) % 4], q), ++count;
            break;
          }
    EXPECT_EQ(count, kNotches - 1);
    return sum;
  };
  EXPECT_EQ(height(Separation::Free), 0);
  // Nodes on the same side stay apart by height, each from the next.
  EXPECT_EQ(height(Separation::Strong), kNotches - 1);
}

TEST(Quantize, aShortLoopStaysWhileTheArcsOfItsFaultDo) {
  const Progress progress;
  std::mt19937 random(1);
  int changed = 0;
  for (unsigned seed = 0; seed < sample::rounds(100); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const TMesh tmesh = partition(randomMap(seed, true), progress);
    const Dual dual(tmesh);
    QuantizationOptions options;
    options.widen = false;
    const ArcLengths q = quantize(tmesh, options, progress).length;
    for (const Collapse& fault : shortLoopFaults(tmesh, q)) {
      const std::set<ArcId> named(fault.others.begin(), fault.others.end());
      CircuitSearch search(dual);
      for (std::size_t a = 0; a < q.size(); ++a) {
        const int change = random() % 2 == 0 ? 1 : -1;
        const auto circuit = search.through({int(a)}, change, [&](ArcId b, int c, int already) {
          return named.contains(b) || q[b.index] + already + c < 0 ? std::numeric_limits<double>::infinity()
                                                                   : 1.0;
        });
        if (!circuit) continue;
        ArcLengths other = q;
        for (const auto& step : circuit->steps) other[step.arc.index] += step.change;
        EXPECT_TRUE(hasShortLoops(tmesh, other));
        ++changed;
      }
    }
  }
  EXPECT_GE(changed, int(sample::rounds(100) / 100));  // few inputs may have none
}

TEST(Quantize, neighbourhoodsFindTheBestLengthsOfSmallTMeshes) {
  const Progress progress;
  int improved = 0;
  double greedy = 0, found = 0, best = 0;
  for (unsigned seed = 0; seed < sample::rounds(100) && !testing::Test::HasFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const TMesh tmesh = partition(randomMap(seed, true), progress);
    const Dual dual(tmesh);
    const Objective objective(tmesh, QuantizationOptions().virtualWeight);
    const SeparationTest separation(dual, Separation::Free);
    const DoubleCover cover(dual, objective);
    const FaultSearch faults = [&](const ArcLengths& q) { return separation.faults(q); };
    const LengthBounds bounds = boundsOfSeparation(dual, separation);
    ArcLengths start = positiveLengths(dual, objective, progress);
    improveGreedily(dual, objective, separation, start, progress);
    ArcLengths q = start;
    improveInNeighbourhoods(dual, cover, faults, bounds, 1000000, q, progress);
    EXPECT_TRUE(isConsistent(dual, q));
    EXPECT_FALSE(separation.fault(q));
    EXPECT_LE(objective(q), objective(start));
    const Optimum optimum =
        leastLengths(dual, cover, faults, q, bounds, *leastDeviation(cover, bounds, q), 1000000, progress);
    if (!optimum.proven) continue;
    improved += objective(q) < objective(start);
    greedy += objective(start), found += objective(q), best += objective(optimum.length);
  }
  EXPECT_GT(improved, 0);
  EXPECT_GT(greedy, 1.05 * best);
  EXPECT_LT(found, 1.02 * best);
}

TEST(Quantize, lengthsWithoutShortLoopsAreProvenToo) {
  // A torus a twentieth of a quad around, which needs three: the objective is far above that of one.
  const Progress progress;
  const TMesh tmesh = partition(gridMapOf(wrapped(12, 8, 0.05, 0.55, true), 30), progress);
  QuantizationOptions options;
  options.optimal = true;
  const Quantization wide = quantize(tmesh, options, progress);
  EXPECT_GT(wide.widened, 0);
  EXPECT_EQ(wide.method, "optimal");
  EXPECT_FALSE(hasShortLoops(tmesh, wide.length));
  options.widen = false;
  const Quantization narrow = quantize(tmesh, options, progress);
  EXPECT_TRUE(hasShortLoops(tmesh, narrow.length));
  EXPECT_GT(wide.lowerBound, narrow.lowerBound + 0.1);
}

TEST(Quantize, theProvenOptimumIsTheOptimum) {
  const Progress progress;
  int proven = 0;
  double greedy = 0, optimal = 0;
  for (unsigned seed = 0; seed < sample::rounds(200) && !testing::Test::HasFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const GridMap map = randomMap(seed, true);
    const TMesh tmesh = partition(map, progress);
    if (tmesh.arcs.size() > 22) continue;
    QuantizationOptions options;
    options.optimal = true;
    const Quantization best = quantize(tmesh, options, progress);
    EXPECT_LE(best.lowerBound, best.objective + 1e-9);
    const Quantization fast = quantize(tmesh, {}, progress);
    EXPECT_GE(fast.objective, best.objective - 1e-9);
    if (best.method != "optimal" || best.objective > 4) continue;
    ++proven;
    greedy += fast.objective, optimal += best.objective;
    const Dual dual(tmesh);
    const Exhaustive all(dual, Objective(tmesh, options.virtualWeight),
                         SeparationTest(dual, Separation::Free), best.objective + 1e-3);
    EXPECT_NEAR(all.best(), best.objective, 1e-4);
  }
  EXPECT_GT(proven, int(sample::rounds(200) / 20));
  RecordProperty("greedy", std::to_string(greedy));
  RecordProperty("optimal", std::to_string(optimal));
}
