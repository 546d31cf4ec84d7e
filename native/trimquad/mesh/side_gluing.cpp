#include "trimquad/mesh/side_gluing.h"

#include <algorithm>
#include <numeric>
#include <string>

#include "trimquad/base/disjoint_sets.h"
#include "trimquad/base/error.h"

namespace trimquad {
namespace {

/// A side with its ends in ascending order.
struct Side {
  int low, high, index;
  bool sameEnds(const Side& other) const { return low == other.low && high == other.high; }
};

int from(const TriangleSoup& soup, int side) {
  return soup.triangles[side / 3][side % 3];
}
int to(const TriangleSoup& soup, int side) {
  return soup.triangles[side / 3][(side % 3 + 1) % 3];
}

/// All sides, grouped by their ends. `label` is by vertex.
std::vector<Side> sortedSides(const TriangleSoup& soup, const std::vector<int>& label) {
  std::vector<Side> sides;
  sides.reserve(3 * soup.triangles.size());
  for (int s = 0; s < int(3 * soup.triangles.size()); ++s) {
    const auto [low, high] = std::minmax({label[from(soup, s)], label[to(soup, s)]});
    sides.push_back({low, high, s});
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::array{a.low, a.high, a.index} < std::array{b.low, b.high, b.index};
  });
  return sides;
}

/// Calls visit(first, last) for each group of sides with the same ends.
template <class Visit>
void forEachEdge(const std::vector<Side>& sides, Visit visit) {
  for (auto first = sides.begin(); first != sides.end();) {
    const auto last = std::find_if(first, sides.end(), [&](const Side& s) { return !s.sameEnds(*first); });
    visit(first, last);
    first = last;
  }
}

std::vector<int> ownLabels(std::size_t count) {
  std::vector<int> labels(count);
  std::iota(labels.begin(), labels.end(), 0);
  return labels;
}

}  // namespace

void requireManifoldEdges(const TriangleSoup& soup) {
  int count = 0;
  std::optional<Side> worst;
  forEachEdge(sortedSides(soup, ownLabels(soup.points.size())), [&](auto first, auto last) {
    if (last - first <= 2) return;
    if (++count == 1) worst = *first;
  });
  if (!worst) return;
  const Eigen::Vector3d middle = 0.5 * (soup.points[worst->low] + soup.points[worst->high]);
  throw inputError("tessellate",
                   (count == 1 ? std::string("an edge has") : std::to_string(count) + " edges have") +
                       " more than two triangles, so that the surface branches; take it apart there first",
                   "vertices " + std::to_string(worst->low) + " and " + std::to_string(worst->high), middle);
}

SideGluing glueSides(const TriangleSoup& soup, const std::vector<int>& place) {
  requireManifoldEdges(soup);
  SideGluing gluing;
  gluing.opposite.resize(3 * soup.triangles.size());
  gluing.sameDirection.resize(3 * soup.triangles.size(), false);
  const auto glue = [&](int a, int b) {
    gluing.opposite[a] = b;
    gluing.opposite[b] = a;
    gluing.sameDirection[a] = gluing.sameDirection[b] = place[from(soup, a)] == place[from(soup, b)];
  };
  forEachEdge(sortedSides(soup, ownLabels(soup.points.size())), [&](auto first, auto last) {
    if (last - first == 2) glue(first->index, (first + 1)->index);
  });
  forEachEdge(sortedSides(soup, place), [&](auto first, auto last) {
    if (last - first == 2 && !gluing.opposite[first->index]) glue(first->index, (first + 1)->index);
  });
  return gluing;
}

std::vector<int> cornerFans(const TriangleSoup& soup, const SideGluing& gluing) {
  DisjointSets fans(3 * soup.triangles.size());
  const auto next = [](int side) { return side % 3 == 2 ? side - 2 : side + 1; };
  for (int s = 0; s < int(gluing.opposite.size()); ++s) {
    if (!gluing.opposite[s]) continue;
    const int o = *gluing.opposite[s];
    fans.unite(s, gluing.sameDirection[s] ? o : next(o));
    fans.unite(next(s), gluing.sameDirection[s] ? next(o) : o);
  }
  std::vector<int> fan(3 * soup.triangles.size());
  for (int c = 0; c < int(fan.size()); ++c) fan[c] = fans.root(c);
  return fan;
}

std::vector<int> components(const SideGluing& gluing) {
  DisjointSets sets(gluing.opposite.size() / 3);
  for (int s = 0; s < int(gluing.opposite.size()); ++s)
    if (gluing.opposite[s]) sets.unite(s / 3, *gluing.opposite[s] / 3);
  std::vector<int> component(gluing.opposite.size() / 3);
  for (int t = 0; t < int(component.size()); ++t) component[t] = sets.root(t);
  return component;
}

}  // namespace trimquad
