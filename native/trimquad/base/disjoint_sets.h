#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace trimquad {

/// Sets of the numbers 0 .. count-1 that only ever grow together. The smallest member represents a set, so
/// that results do not depend on the order of the unions.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }

  int root(int x) {
    while (parent_[x] != x) x = parent_[x] = parent_[parent_[x]];
    return x;
  }

  void unite(int a, int b) {
    a = root(a), b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<int> parent_;
};

}  // namespace trimquad
