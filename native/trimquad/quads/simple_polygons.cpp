#include "trimquad/quads/simple_polygons.h"

#include <algorithm>
#include <optional>
#include <tuple>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

class Divider {
 public:
  explicit Divider(const std::vector<PlanarLoop>& loops) : loops_(loops) {}

  SimplePolygons run() {
    PlanarLoop joined = loops_[0];
    std::vector<bool> waiting(loops_.size(), true);
    waiting[0] = false;
    for (size_t k = 1; k < loops_.size(); ++k) joined = joinNearest(joined, waiting);
    std::vector<PlanarLoop> open{joined};
    SimplePolygons simple;
    while (!open.empty()) {
      const PlanarLoop chain = open.back();
      open.pop_back();
      if (repeatedPositions(chain).empty()) {
        auto& polygon = simple.polygons.emplace_back();
        for (const auto& corner : chain) polygon.push_back(corner.point);
        continue;
      }
      const auto [i, j] = bestDiagonal(chain);
      open.emplace_back(chain.begin() + long(i), chain.begin() + long(j) + 1);
      PlanarLoop rest(chain.begin() + long(j), chain.end());
      rest.insert(rest.end(), chain.begin(), chain.begin() + long(i) + 1);
      open.push_back(rest);
    }
    for (const auto& [p, q] : bridges_) simple.innerEnds += p.inner + q.inner;
    return simple;
  }

 private:
  /// How often the segment p -> q meets loop edges and bridges, other than in its own ends.
  int crossings(const PlanarCorner& p, const PlanarCorner& q) const {
    int count = trimquad::crossings(loops_, p, q);
    for (const auto& [r, s] : bridges_) count += meet(p, q, r, s);
    return count;
  }

  /// Joins the chain with the nearest loop that is still apart, by a bridge there and back.
  PlanarLoop joinNearest(const PlanarLoop& chain, std::vector<bool>& waiting) {
    using Score = std::tuple<int, int, WideQuanta>;  // crossings, inner ends, length
    std::optional<Score> best;
    size_t bestCorner = 0, bestLoop = 0, bestEnd = 0;
    for (size_t i = 0; i < chain.size(); ++i)
      for (size_t loop = 1; loop < loops_.size(); ++loop) {
        if (!waiting[loop]) continue;
        const PlanarLoop& hole = loops_[loop];
        for (size_t k = 0; k < hole.size(); ++k) {
          const WideQuanta length = squaredDistance(chain[i], hole[k]);
          const int inner = chain[i].inner + hole[k].inner;
          if (best && Score{0, inner, length} >= *best) continue;
          const int wrong = !leadsInside(chain, i, hole[k].at) + !leadsInside(hole, k, chain[i].at);
          const Score score{wrong + crossings(chain[i], hole[k]), inner, length};
          if (best && score >= *best) continue;
          best = score, bestCorner = i, bestLoop = loop, bestEnd = k;
        }
      }
    TRIMQUAD_ASSERT(best);
    waiting[bestLoop] = false;
    const PlanarLoop& hole = loops_[bestLoop];
    bridges_.push_back({chain[bestCorner], hole[bestEnd]});
    PlanarLoop joined(chain.begin(), chain.begin() + long(bestCorner) + 1);
    for (size_t k = 0; k <= hole.size(); ++k) joined.push_back(hole[(bestEnd + k) % hole.size()]);
    joined.insert(joined.end(), chain.begin() + long(bestCorner), chain.end());
    return joined;
  }

  /// The diagonal that leaves the fewest repeated corners, has the fewest inner ends and divides most evenly,
  /// among those that cross nothing.
  std::pair<size_t, size_t> bestDiagonal(const PlanarLoop& chain) {
    using Candidate = std::tuple<int, int, size_t, WideQuanta, size_t,
                                 size_t>;  // repeats left, inner ends, larger part, length, ends
    const size_t n = chain.size();
    const auto twins = repeatedPositions(chain);
    std::vector<Candidate> candidates;
    for (size_t i = 0; i < n; ++i)
      for (size_t j = i + 2; j < n && j < i + n - 1; ++j) {
        if (chain[i].point == chain[j].point) continue;
        int left = 0;
        for (const auto& [p, q] : twins) {
          const bool inPart = i <= p && q <= j, inRest = (p <= i || p >= j) && (q <= i || q >= j);
          left += inPart || inRest;
        }
        const int inner = chain[i].inner + chain[j].inner;
        candidates.push_back(
            {left, inner, std::max(j - i, n - (j - i)), squaredDistance(chain[i], chain[j]), i, j});
      }
    std::sort(candidates.begin(), candidates.end());
    TRIMQUAD_ASSERT(!candidates.empty());
    std::pair<size_t, size_t> ends;
    std::optional<int> fewest;
    for (const auto& [left, inner, larger, length, i, j] : candidates) {
      const int wrong = !leadsInside(chain, i, chain[j].at) + !leadsInside(chain, j, chain[i].at) +
                        crossings(chain[i], chain[j]) + isFlat(chain, i, j) + isFlat(chain, j, i);
      if (!fewest || wrong < *fewest) fewest = wrong, ends = {i, j};
      if (wrong == 0) break;
    }
    bridges_.push_back({chain[ends.first], chain[ends.second]});
    return ends;
  }

  /// Whether nothing but a line is beyond a diagonal, along straight sides.
  static bool isFlat(const PlanarLoop& chain, size_t from, size_t to) {
    constexpr int kFlatBits = 30;
    const WideQuanta area = doubleArea(stretch(chain, from, to));
    return (std::max(area, -area) << kFlatBits) <= squaredDistance(chain[from], chain[to]);
  }

  /// Pairs of positions in the chain that hold the same corner.
  static std::vector<std::pair<size_t, size_t>> repeatedPositions(const PlanarLoop& chain) {
    std::vector<std::pair<int, size_t>> sorted;
    for (size_t i = 0; i < chain.size(); ++i) sorted.push_back({chain[i].point, i});
    std::sort(sorted.begin(), sorted.end());
    std::vector<std::pair<size_t, size_t>> pairs;
    for (size_t i = 1; i < sorted.size(); ++i)
      if (sorted[i].first == sorted[i - 1].first) pairs.push_back({sorted[i - 1].second, sorted[i].second});
    return pairs;
  }

  const std::vector<PlanarLoop>& loops_;
  std::vector<std::pair<PlanarCorner, PlanarCorner>> bridges_;
};

}  // namespace

SimplePolygons simplePolygons(const std::vector<PlanarLoop>& loops) {
  return Divider(loops).run();
}

}  // namespace trimquad
