#include "trimquad/mesh/touching_regions.h"

#include <algorithm>

namespace trimquad {

std::vector<int> touchingRegions(const Model& model, int region) {
  std::vector<char> there(model.corners.size(), 0);
  for (const auto& corner : model.regions.at(std::size_t(region)).corner)
    if (corner) there[corner->index] = 1;
  std::vector<int> touching;
  for (int r = 0; r < int(model.regions.size()); ++r) {
    const auto& corners = model.regions[r].corner;
    if (std::any_of(corners.begin(), corners.end(), [&](const auto& c) { return c && there[c->index]; }))
      touching.push_back(r);
  }
  return touching;
}

}  // namespace trimquad
