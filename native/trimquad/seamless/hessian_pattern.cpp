#include "trimquad/seamless/hessian_pattern.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace trimquad {
namespace {

using Basis = HessianPattern::Basis;
using Terms = Basis::InnerIterator;

int termCount(const Basis& basis, int variable) {
  return basis.outerIndexPtr()[variable + 1] - basis.outerIndexPtr()[variable];
}

bool isUnknown(const Basis& basis, int variable) {
  return termCount(basis, variable) == 1 && Terms(basis, variable).value() == 1;
}

/// By variable: the first one that is the same sum.
std::vector<int> representatives(const Basis& basis) {
  const int* const outer = basis.outerIndexPtr();
  const auto compare = [&](int a, int b) {
    const int na = termCount(basis, a), nb = termCount(basis, b);
    if (na != nb) return na < nb ? -1 : 1;
    for (int k = 0; k < na; ++k) {
      const int p = outer[a] + k, q = outer[b] + k;
      const auto x = std::tuple(basis.innerIndexPtr()[p], basis.valuePtr()[p]),
                 y = std::tuple(basis.innerIndexPtr()[q], basis.valuePtr()[q]);
      if (x != y) return x < y ? -1 : 1;
    }
    return 0;
  };
  std::vector<int> order(basis.rows()), first(basis.rows());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    const int c = compare(a, b);
    return c != 0 ? c < 0 : a < b;
  });
  for (size_t i = 0; i < order.size(); ++i)
    first[order[i]] = i > 0 && compare(order[i], order[i - 1]) == 0 ? first[order[i - 1]] : order[i];
  return first;
}

}  // namespace

HessianPattern::HessianPattern(const Basis& basis, const std::vector<Corners>& triangles) : basis_(basis) {
  basis_.makeCompressed();
  findPairs(triangles);
  findPlaces(triangles);
}

void HessianPattern::findPairs(const std::vector<Corners>& triangles) {
  const auto first = representatives(basis_);
  const auto pairsOf = [&](const Corners& corners, const auto& visit) {
    for (int k = 0; k < 36; ++k) visit(k, std::array{first[corners[k % 6]], first[corners[k / 6]]});
  };
  std::vector<std::array<int, 2>> distinct;
  for (const auto& corners : triangles) {
    const bool plain = std::all_of(corners.begin(), corners.end(),
                                   [&](int variable) { return isUnknown(basis_, variable); });
    triangles_.push_back({plain, 36 * triangles_.size()});
    if (!plain) pairsOf(corners, [&](int, const auto& pair) { distinct.push_back(pair); });
  }
  std::sort(distinct.begin(), distinct.end());
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  pairs_.reserve(distinct.size());
  size_t places = 0;
  for (const auto& [row, column] : distinct) {
    pairs_.push_back({row, column, places});
    places += size_t(termCount(basis_, row)) * size_t(termCount(basis_, column));
  }
  place_.resize(places);
  entry_.resize(36 * triangles.size());
  for (size_t t = 0; t < triangles.size(); ++t)
    if (!triangles_[t].plain)
      pairsOf(triangles[t], [&](int k, const auto& pair) {
        entry_[36 * t + k] = int(std::lower_bound(distinct.begin(), distinct.end(), pair) - distinct.begin());
      });
}

void HessianPattern::findPlaces(const std::vector<Corners>& triangles) {
  const int n = int(basis_.cols());
  const auto unknownOf = [&](int variable) {
    return basis_.innerIndexPtr()[basis_.outerIndexPtr()[variable]];
  };
  // Column by column of the Hessian: corners of plain triangles that are the unknown, and terms of pairs
  // whose second variable has it.
  struct Use {
    int owner, term;
  };
  const auto collect = [&](const auto& forEach) {
    std::vector<int> start(n + 1, 0);
    forEach([&](int column, Use) { ++start[column + 1]; });
    std::partial_sum(start.begin(), start.end(), start.begin());
    std::vector<Use> uses(start.back());
    std::vector<int> next(start.begin(), start.end() - 1);
    forEach([&](int column, Use use) { uses[next[column]++] = use; });
    return std::pair(std::move(start), std::move(uses));
  };
  const auto [plainStart, plainUses] = collect([&](const auto& visit) {
    for (int t = 0; t < int(triangles.size()); ++t)
      for (int k = 0; triangles_[t].plain && k < 6; ++k) visit(unknownOf(triangles[t][k]), Use{t, k});
  });
  const auto [pairStart, pairUses] = collect([&](const auto& visit) {
    for (int p = 0; p < int(pairs_.size()); ++p) {
      int term = 0;
      for (Terms s(basis_, pairs_[p].column); s; ++s, ++term) visit(int(s.col()), Use{p, term});
    }
  });
  std::vector<int> outer{0}, inner, slot(n), seenFrom(n, n), column;
  outer.reserve(n + 1);
  for (int b = 0; b < n; ++b) {
    seenFrom[b] = b;
    column.assign(1, b);  // the diagonal, even where no triangle depends on the unknown
    const auto see = [&](int a) {
      if (seenFrom[a] == b) return;
      seenFrom[a] = b;
      column.push_back(a);
    };
    for (int u = plainStart[b]; u < plainStart[b + 1]; ++u)
      for (const int variable : triangles[plainUses[u].owner]) see(unknownOf(variable));
    for (int u = pairStart[b]; u < pairStart[b + 1]; ++u)
      for (Terms r(basis_, pairs_[pairUses[u].owner].row); r; ++r) see(int(r.col()));
    std::sort(column.begin(), column.end());
    for (size_t i = 0; i < column.size(); ++i) slot[column[i]] = int(inner.size() + i);
    for (int u = plainStart[b]; u < plainStart[b + 1]; ++u) {
      const auto& [t, k] = plainUses[u];
      for (int i = 0; i < 6; ++i)
        entry_[triangles_[t].first + size_t(6 * k + i)] = slot[unknownOf(triangles[t][i])];
    }
    for (int u = pairStart[b]; u < pairStart[b + 1]; ++u) {
      const Pair& pair = pairs_[pairUses[u].owner];
      size_t place = pair.firstPlace + size_t(pairUses[u].term) * size_t(termCount(basis_, pair.row));
      for (Terms r(basis_, pair.row); r; ++r) place_[place++] = slot[r.col()];
    }
    inner.insert(inner.end(), column.begin(), column.end());
    outer.push_back(int(inner.size()));
  }
  const std::vector<double> zeros(inner.size(), 0.0);
  zero_ = Eigen::Map<const Eigen::SparseMatrix<double>>(n, n, Eigen::Index(inner.size()), outer.data(),
                                                        inner.data(), zeros.data());
}

void HessianPattern::add(int t, const Eigen::Matrix<double, 6, 6>& second, Sum& sum) const {
  const Triangle& triangle = triangles_[t];
  const int* const entries = entry_.data() + triangle.first;
  double* const values = triangle.plain ? sum.hessian.valuePtr() : sum.byPair.data();
  for (int i = 0; i < 36; ++i) values[entries[i]] += second.data()[i];
}

Eigen::SparseMatrix<double> HessianPattern::finish(Sum&& sum) const {
  double* const values = sum.hessian.valuePtr();
  for (size_t p = 0; p < pairs_.size(); ++p) {
    const double second = sum.byPair[p];
    if (second == 0) continue;
    size_t place = pairs_[p].firstPlace;
    for (Terms s(basis_, pairs_[p].column); s; ++s)
      for (Terms r(basis_, pairs_[p].row); r; ++r) values[place_[place++]] += second * s.value() * r.value();
  }
  return std::move(sum.hessian);
}

}  // namespace trimquad
