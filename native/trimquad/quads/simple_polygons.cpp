#include "trimquad/quads/simple_polygons.h"

#include <algorithm>
#include <optional>
#include <tuple>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

using Chain = std::vector<PlanarCorner>;  // closed

class Divider {
 public:
  explicit Divider(const std::vector<Chain>& loops) : loops_(loops) {}

  std::vector<Chain> run() {
    Chain joined = loops_[0];
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
      open.emplace_back(chain.begin() + long(i), chain.begin() + long(j) + 1);
      Chain rest(chain.begin() + long(j), chain.end());
      rest.insert(rest.end(), chain.begin(), chain.begin() + long(i) + 1);
      open.push_back(rest);
    }
    return simple;
  }

 private:
  /// How often the segment p -> q meets loop edges and bridges, other than in its own ends.
  int crossings(const PlanarCorner& p, const PlanarCorner& q) const {
    int count = 0;
    for (const auto& loop : loops_)
      for (size_t k = 0; k < loop.size(); ++k) count += meets(p, q, loop[k], loop[(k + 1) % loop.size()]);
    for (const auto& [r, s] : bridges_) count += meets(p, q, r, s);
    return count;
  }

  static bool meets(const PlanarCorner& p, const PlanarCorner& q, const PlanarCorner& r,
                    const PlanarCorner& s) {
    const auto inside = [](const PlanarCorner& a, const PlanarCorner& b, const PlanarCorner& x) {
      return x.point != a.point && x.point != b.point && orientation(a.at, b.at, x.at) == 0 &&
             dot(a.at - x.at, b.at - x.at) <= 0;
    };
    if (inside(p, q, r) || inside(p, q, s) || inside(r, s, p) || inside(r, s, q)) return true;
    return orientation(p.at, q.at, r.at) * orientation(p.at, q.at, s.at) < 0 &&
           orientation(r.at, s.at, p.at) * orientation(r.at, s.at, q.at) < 0;
  }

  /// Whether the direction from corner i of the chain to `x` leads into the chain's inside.
  bool leadsInside(const Chain& chain, size_t i, FixedVector x) const {
    const FixedVector here = chain[i].at;
    const FixedVector out = chain[(i + 1) % chain.size()].at - here;
    const FixedVector in = chain[(i + chain.size() - 1) % chain.size()].at - here;
    return strictlyInsideSector(out, in, x - here);
  }

  static WideQuanta squaredDistance(const PlanarCorner& p, const PlanarCorner& q) {
    return dot(q.at - p.at, q.at - p.at);
  }

  /// Joins the chain with the nearest loop that is still apart, by a bridge there and back.
  Chain joinNearest(const Chain& chain, std::vector<bool>& waiting) {
    using Score = std::tuple<int, int, WideQuanta>;  // crossings, inner ends, length
    std::optional<Score> best;
    size_t bestCorner = 0, bestLoop = 0, bestEnd = 0;
    for (size_t i = 0; i < chain.size(); ++i)
      for (size_t loop = 1; loop < loops_.size(); ++loop) {
        if (!waiting[loop]) continue;
        const Chain& hole = loops_[loop];
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
    const Chain& hole = loops_[bestLoop];
    bridges_.push_back({chain[bestCorner], hole[bestEnd]});
    Chain joined(chain.begin(), chain.begin() + long(bestCorner) + 1);
    for (size_t k = 0; k <= hole.size(); ++k) joined.push_back(hole[(bestEnd + k) % hole.size()]);
    joined.insert(joined.end(), chain.begin() + long(bestCorner), chain.end());
    return joined;
  }

  /// The diagonal that leaves the fewest repeated corners, has the fewest inner ends and divides most evenly,
  /// among those that cross nothing.
  std::pair<size_t, size_t> bestDiagonal(const Chain& chain) {
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
                        crossings(chain[i], chain[j]);
      if (!fewest || wrong < *fewest) fewest = wrong, ends = {i, j};
      if (wrong == 0) break;
    }
    bridges_.push_back({chain[ends.first], chain[ends.second]});
    return ends;
  }

  /// Pairs of positions in the chain that hold the same corner.
  static std::vector<std::pair<size_t, size_t>> repeatedPositions(const Chain& chain) {
    std::vector<std::pair<int, size_t>> sorted;
    for (size_t i = 0; i < chain.size(); ++i) sorted.push_back({chain[i].point, i});
    std::sort(sorted.begin(), sorted.end());
    std::vector<std::pair<size_t, size_t>> pairs;
    for (size_t i = 1; i < sorted.size(); ++i)
      if (sorted[i].first == sorted[i - 1].first) pairs.push_back({sorted[i - 1].second, sorted[i].second});
    return pairs;
  }

  const std::vector<Chain>& loops_;
  std::vector<std::pair<PlanarCorner, PlanarCorner>> bridges_;
};

}  // namespace

std::vector<std::vector<int>> simplePolygons(const std::vector<std::vector<PlanarCorner>>& loops) {
  std::vector<std::vector<int>> polygons;
  for (const auto& chain : Divider(loops).run()) {
    auto& polygon = polygons.emplace_back();
    for (const auto& corner : chain) polygon.push_back(corner.point);
  }
  return polygons;
}

}  // namespace trimquad
