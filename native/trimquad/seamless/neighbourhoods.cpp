#include "trimquad/seamless/neighbourhoods.h"

#include <algorithm>

#include "trimquad/base/disjoint_sets.h"

namespace trimquad {

Neighbourhoods::Neighbourhoods(const MapEnergy& energy) {
  constexpr int kMany = 100;  // more than triangles around a vertex
  const int faces = energy.faceCount(), unknowns = energy.unknownCount();
  Lists all;
  std::vector<int> uses(unknowns, 0);
  for (int f = 0; f < faces; ++f) {
    for (const int unknown : energy.unknownsOf(f)) {
      all.element.push_back(unknown);
      ++uses[unknown];
    }
    all.start.push_back(int(all.element.size()));
  }
  for (int i = 0; i < unknowns; ++i)
    facesOf_.start.push_back(facesOf_.start[i] + (uses[i] <= kMany ? uses[i] : 0));
  facesOf_.element.resize(facesOf_.start.back());
  std::vector<int> next(facesOf_.start.begin(), facesOf_.start.end() - 1);
  for (int f = 0; f < faces; ++f) {
    for (const int unknown : all[f]) {
      if (uses[unknown] > kMany) continue;
      unknownsOf_.element.push_back(unknown);
      facesOf_.element[next[unknown]++] = f;
    }
    unknownsOf_.start.push_back(int(unknownsOf_.element.size()));
  }
}

std::vector<Neighbourhood> Neighbourhoods::around(const std::vector<FaceHandle>& faces, int rings) const {
  std::vector<char> inside(unknownsOf_.start.size() - 1, 0);
  std::vector<int> region;
  for (const auto f : faces) inside[f.idx()] = 1, region.push_back(f.idx());
  size_t first = 0;
  for (int ring = 0; ring < rings; ++ring)
    for (const size_t last = region.size(); first < last; ++first)
      for (const int unknown : unknownsOf_[region[first]])
        for (const int f : facesOf_[unknown])
          if (!inside[f]) inside[f] = 1, region.push_back(f);
  std::sort(region.begin(), region.end());

  // Free are the unknowns that nothing outside depends on.
  std::vector<int> uses(facesOf_.start.size() - 1, 0);
  for (const int f : region)
    for (const int unknown : unknownsOf_[f]) ++uses[unknown];
  std::vector<int> free;
  for (const int f : region)
    for (const int unknown : unknownsOf_[f])
      if (uses[unknown] == facesOf_[unknown].size()) free.push_back(unknown);
  std::sort(free.begin(), free.end());
  free.erase(std::unique(free.begin(), free.end()), free.end());
  std::vector<int>& place = uses;  // from now on, -1 where not free
  std::fill(place.begin(), place.end(), -1);
  for (int i = 0; i < int(free.size()); ++i) place[free[i]] = i;

  DisjointSets sets(free.size());
  std::vector<int> anyFree(region.size(), -1);
  for (size_t i = 0; i < region.size(); ++i)
    for (const int unknown : unknownsOf_[region[i]]) {
      if (place[unknown] < 0) continue;
      if (anyFree[i] < 0) anyFree[i] = place[unknown];
      sets.unite(anyFree[i], place[unknown]);
    }
  std::vector<Neighbourhood> parts;
  std::vector<int> part(free.size(), -1);
  for (int i = 0; i < int(free.size()); ++i) {
    int& number = part[sets.root(i)];
    if (number < 0) number = int(parts.size()), parts.emplace_back();
    parts[number].unknowns.push_back(free[i]);
  }
  for (size_t i = 0; i < region.size(); ++i)
    if (anyFree[i] >= 0) parts[part[sets.root(anyFree[i])]].faces.push_back(region[i]);
  return parts;
}

}  // namespace trimquad
