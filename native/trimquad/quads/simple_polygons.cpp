#include "trimquad/quads/simple_polygons.h"

#include <algorithm>
#include <optional>
#include <tuple>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

using Chain = std::vector<LoopCorner>;  // closed

class Divider {
 public:
  explicit Divider(const std::vector<std::vector<FixedVector>>& loops) : loops_(loops) {}

  std::vector<Chain> run() {
    Chain joined = chainOf(0);
    std::vector<bool> waiting(loops_.size(), true);
    waiting[0] = false;
    for (size_t k = 1; k < loops_.size(); ++k) joined = joinNearest(joined, waiting);
    std::vector<Chain> open{joined}, simple;
    while (!open.empty()) {
      const Chain chain = open.back();
      open.pop_back();
      if (repeatedPositions(chain).empty()) {
        simple.push_back(chain);
        continue;
      }
      const auto [i, j] = bestDiagonal(chain);
      open.emplace_back(chain.begin() + i, chain.begin() + j + 1);
      Chain rest(chain.begin() + j, chain.end());
      rest.insert(rest.end(), chain.begin(), chain.begin() + i + 1);
      open.push_back(rest);
    }
    return simple;
  }

 private:
  FixedVector at(LoopCorner c) const { return loops_[c.loop][c.corner]; }

  Chain chainOf(int loop) const {
    Chain chain;
    for (int k = 0; k < int(loops_[loop].size()); ++k) chain.push_back({loop, k});
    return chain;
  }

  /// How often the segment p -> q meets loop edges, other than in its own ends.
  int crossings(LoopCorner p, LoopCorner q) const {
    const FixedVector a = at(p), b = at(q);
    int count = 0;
    for (int loop = 0; loop < int(loops_.size()); ++loop)
      for (int k = 0; k < int(loops_[loop].size()); ++k) {
        const LoopCorner r{loop, k}, s{loop, int((k + 1) % loops_[loop].size())};
        count += meets(a, b, r, s, p, q);
      }
    for (const auto& [r, s] : bridges_) count += meets(a, b, r, s, p, q);
    return count;
  }

  bool meets(FixedVector a, FixedVector b, LoopCorner r, LoopCorner s, LoopCorner p, LoopCorner q) const {
    const FixedVector c = at(r), d = at(s);
    const auto onSegment = [](FixedVector from, FixedVector to, FixedVector x) {
      return orientation(from, to, x) == 0 && dot(from - x, to - x) < 0;
    };
    if (r == p || r == q || s == p || s == q)
      return (r != p && r != q && onSegment(a, b, c)) || (s != p && s != q && onSegment(a, b, d)) ||
             (onSegment(c, d, a) || onSegment(c, d, b));
    const int o1 = orientation(a, b, c), o2 = orientation(a, b, d), o3 = orientation(c, d, a),
              o4 = orientation(c, d, b);
    if (o1 * o2 < 0 && o3 * o4 < 0) return true;
    return onSegment(a, b, c) || onSegment(a, b, d) || onSegment(c, d, a) || onSegment(c, d, b);
  }

  /// Whether the direction from corner i of the chain to `x` leads into the chain's inside.
  bool leadsInside(const Chain& chain, size_t i, FixedVector x) const {
    const FixedVector here = at(chain[i]);
    const FixedVector out = at(chain[(i + 1) % chain.size()]) - here;
    const FixedVector in = at(chain[(i + chain.size() - 1) % chain.size()]) - here;
    return strictlyInsideSector(out, in, x - here);
  }

  WideQuanta squaredDistance(LoopCorner p, LoopCorner q) const { return dot(at(q) - at(p), at(q) - at(p)); }

  /// Joins the chain with the nearest loop that is still apart, by a bridge there and back.
  Chain joinNearest(const Chain& chain, std::vector<bool>& waiting) {
    using Score = std::tuple<int, WideQuanta>;
    std::optional<Score> best;
    size_t bestCorner = 0;
    LoopCorner bestEnd{};
    for (size_t i = 0; i < chain.size(); ++i)
      for (int loop = 1; loop < int(loops_.size()); ++loop) {
        if (!waiting[loop]) continue;
        const Chain hole = chainOf(loop);
        for (size_t k = 0; k < hole.size(); ++k) {
          const WideQuanta length = squaredDistance(chain[i], hole[k]);
          if (best && std::get<0>(*best) == 0 && length >= std::get<1>(*best)) continue;
          const int wrong = !leadsInside(chain, i, at(hole[k])) + !leadsInside(hole, k, at(chain[i]));
          const Score score{wrong + crossings(chain[i], hole[k]), length};
          if (best && score >= *best) continue;
          best = score, bestCorner = i, bestEnd = hole[k];
        }
      }
    TRIMQUAD_ASSERT(best);
    waiting[bestEnd.loop] = false;
    bridges_.push_back({chain[bestCorner], bestEnd});
    Chain joined(chain.begin(), chain.begin() + bestCorner + 1);
    const int size = int(loops_[bestEnd.loop].size());
    for (int k = 0; k <= size; ++k) joined.push_back({bestEnd.loop, (bestEnd.corner + k) % size});
    joined.insert(joined.end(), chain.begin() + bestCorner, chain.end());
    return joined;
  }

  /// The diagonal that leaves the fewest repeated corners and divides most evenly, among those that cross
  /// nothing.
  std::pair<size_t, size_t> bestDiagonal(const Chain& chain) {
    using Candidate =
        std::tuple<int, size_t, WideQuanta, size_t, size_t>;  // repeats left, larger part, length, ends
    const size_t n = chain.size();
    const auto twins = repeatedPositions(chain);
    std::vector<Candidate> candidates;
    for (size_t i = 0; i < n; ++i)
      for (size_t j = i + 2; j < n && j < i + n - 1; ++j) {
        if (chain[i] == chain[j]) continue;
        int left = 0;
        for (const auto& [p, q] : twins) {
          const bool inPart = i <= p && q <= j, inRest = (p <= i || p >= j) && (q <= i || q >= j);
          left += inPart || inRest;
        }
        candidates.push_back({left, std::max(j - i, n - (j - i)), squaredDistance(chain[i], chain[j]), i, j});
      }
    std::sort(candidates.begin(), candidates.end());
    TRIMQUAD_ASSERT(!candidates.empty());
    std::pair<size_t, size_t> ends;
    std::optional<int> fewest;
    for (const auto& [left, larger, length, i, j] : candidates) {
      const int wrong = !leadsInside(chain, i, at(chain[j])) + !leadsInside(chain, j, at(chain[i])) +
                        crossings(chain[i], chain[j]);
      if (!fewest || wrong < *fewest) fewest = wrong, ends = {i, j};
      if (wrong == 0) break;
    }
    bridges_.push_back({chain[ends.first], chain[ends.second]});
    return ends;
  }

  /// Pairs of positions in the chain that hold the same corner.
  static std::vector<std::pair<size_t, size_t>> repeatedPositions(const Chain& chain) {
    std::vector<std::pair<LoopCorner, size_t>> sorted;
    for (size_t i = 0; i < chain.size(); ++i) sorted.push_back({chain[i], i});
    std::sort(sorted.begin(), sorted.end());
    std::vector<std::pair<size_t, size_t>> pairs;
    for (size_t i = 1; i < sorted.size(); ++i)
      if (sorted[i].first == sorted[i - 1].first) pairs.push_back({sorted[i - 1].second, sorted[i].second});
    return pairs;
  }

  const std::vector<std::vector<FixedVector>>& loops_;
  std::vector<std::pair<LoopCorner, LoopCorner>> bridges_;
};

}  // namespace

std::vector<std::vector<LoopCorner>> simplePolygons(const std::vector<std::vector<FixedVector>>& loops) {
  return Divider(loops).run();
}

}  // namespace trimquad
