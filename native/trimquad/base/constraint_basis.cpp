#include "trimquad/base/constraint_basis.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>

#include "trimquad/base/error.h"
#include "trimquad/base/fixed.h"

namespace trimquad {
namespace {

std::int64_t multiplied(std::int64_t a, std::int64_t b) {
  std::int64_t product = 0;
  if (__builtin_mul_overflow(a, b, &product))
    throw stageError("seamless",
                     "the constraints of the map are too intricate for exact numbers; relax some features");
  return product;
}

void divideByCommonFactor(std::map<int, std::int64_t>& terms, std::int64_t& constant, std::int64_t& divisor) {
  std::int64_t g = std::gcd(divisor, constant);
  for (const auto& [variable, factor] : terms) g = std::gcd(g, factor);
  if (g <= 1) return;
  for (auto& term : terms) term.second /= g;
  constant /= g;
  divisor /= g;
}

}  // namespace

ConstraintBasis::ConstraintBasis(Index variables) : rows_(variables) {}

/// Replaces every dependent variable in `divisor * (...) = sum(terms) + constant`.
void ConstraintBasis::substitute(std::map<Index, std::int64_t>& terms, std::int64_t& constant,
                                 std::int64_t& divisor) const {
  for (;;) {
    auto it = terms.begin();
    while (it != terms.end() && !rows_[it->first].dependent) ++it;
    if (it == terms.end()) break;
    const Row& row = rows_[it->first];
    const std::int64_t factor = it->second;
    terms.erase(it);
    if (row.divisor != 1) {
      for (auto& term : terms) term.second = multiplied(term.second, row.divisor);
      constant = multiplied(constant, row.divisor);
      divisor = multiplied(divisor, row.divisor);
    }
    for (const auto& [variable, f] : row.terms) {
      auto& sum = terms[variable];
      sum += multiplied(factor, f);
      if (sum == 0) terms.erase(variable);
    }
    constant += multiplied(factor, row.constant);
    divideByCommonFactor(terms, constant, divisor);
  }
}

bool ConstraintBasis::isReduced(const Row& row) const {
  return std::none_of(row.terms.begin(), row.terms.end(),
                      [&](const auto& term) { return rows_[term.first].dependent; });
}

/// Makes a dependent variable depend on free ones only. What it depended on is reduced first and stays so,
/// which keeps long chains of equations linear, as path compression does.
void ConstraintBasis::reduce(Index variable) {
  std::vector<Index> path{variable};
  while (!path.empty()) {
    Row& row = rows_[path.back()];
    const size_t length = path.size();
    for (const auto& [other, factor] : row.terms)
      if (rows_[other].dependent && !isReduced(rows_[other])) path.push_back(other);
    if (path.size() > length) continue;
    substitute(row.terms, row.constant, row.divisor);
    path.pop_back();
  }
}

bool ConstraintBasis::addEquation(const std::vector<Term>& terms, std::int64_t constant) {
  std::map<Index, std::int64_t> sum;
  for (const auto& term : terms)
    if ((sum[term.variable] += term.factor) == 0) sum.erase(term.variable);
  for (const auto& [variable, factor] : sum)
    if (rows_[variable].dependent) reduce(variable);
  std::int64_t right = -constant, divisor = 1;  // 0 = sum + right
  substitute(sum, right, divisor);
  if (sum.empty()) return right == 0;
  // The smallest factor makes the smallest divisor; among equals the last variable, so that the variables
  // that were declared first (translations of seams) stay free.
  auto pivot = sum.begin();
  for (auto it = sum.begin(); it != sum.end(); ++it)
    if (std::abs(it->second) <= std::abs(pivot->second)) pivot = it;
  Row row;
  row.dependent = true;
  row.divisor = std::abs(pivot->second);
  const std::int64_t s = pivot->second > 0 ? -1 : 1;
  for (const auto& [variable, factor] : sum)
    if (variable != pivot->first) row.terms[variable] = s * factor;
  row.constant = s * right;
  divideByCommonFactor(row.terms, row.constant, row.divisor);
  rows_[pivot->first] = std::move(row);
  return true;
}

void ConstraintBasis::finish() {
  std::vector<Index> position(rows_.size(), -1);
  for (Index i = 0; i < variableCount(); ++i)
    if (!rows_[i].dependent) {
      position[i] = Index(free_.size());
      free_.push_back(i);
    }
  offset_.setZero(variableCount());
  std::vector<Eigen::Triplet<double>> entries;
  for (Index i = 0; i < variableCount(); ++i) {
    Row& row = rows_[i];
    if (!row.dependent) {
      entries.emplace_back(i, position[i], 1.0);
      continue;
    }
    reduce(i);
    for (const auto& [variable, factor] : row.terms)
      entries.emplace_back(i, position[variable], double(factor) / double(row.divisor));
    offset_[i] = double(row.constant) / double(row.divisor);
  }
  matrix_.resize(variableCount(), freeCount());
  matrix_.setFromTriplets(entries.begin(), entries.end());
}

Eigen::VectorXd ConstraintBasis::restrict(const Eigen::VectorXd& x) const {
  Eigen::VectorXd z(freeCount());
  for (Index i = 0; i < freeCount(); ++i) z[i] = x[free_[i]];
  return z;
}

std::vector<std::int64_t> ConstraintBasis::evaluateExact(const Eigen::VectorXd& z, int bits) const {
  std::vector<std::int64_t> multiple(rows_.size(), 1), x(rows_.size(), 0);
  for (const Row& row : rows_)
    if (row.divisor != 1)
      for (const auto& [variable, factor] : row.terms)
        multiple[variable] = std::lcm(multiple[variable], row.divisor);
  for (Index i = 0; i < freeCount(); ++i) {
    const std::int64_t m = multiple[free_[i]];
    x[free_[i]] = std::llround(std::ldexp(z[i], bits) / double(m)) * m;
  }
  for (Index i = 0; i < variableCount(); ++i) {
    const Row& row = rows_[i];
    if (!row.dependent) continue;
    WideQuanta sum = WideQuanta(row.constant) << bits;
    for (const auto& [variable, factor] : row.terms) sum += WideQuanta(factor) * x[variable];
    // The divisor divides each term by the choice of multiples; it divides the constant as long as it is a
    // power of two below 2^bits, which rotations by quarter turns (determinant 2 or 4) give.
    TRIMQUAD_ASSERT(sum % row.divisor == 0);
    x[i] = std::int64_t(sum / row.divisor);
  }
  return x;
}

}  // namespace trimquad
