#include "trimquad/base/constraint_basis.h"

#include <gtest/gtest.h>

#include <random>

namespace trimquad {
namespace {

TEST(ConstraintBasis, withoutEquationsIsTheIdentity) {
  ConstraintBasis basis(3);
  basis.finish();
  EXPECT_EQ(basis.freeCount(), 3);
  EXPECT_EQ(Eigen::MatrixXd(basis.matrix()), Eigen::MatrixXd::Identity(3, 3));
}

TEST(ConstraintBasis, contradictionIsRefusedAndChangesNothing) {
  ConstraintBasis basis(2);
  EXPECT_TRUE(basis.addEquation({{0, 1}, {1, 1}}, 3));
  EXPECT_TRUE(basis.addEquation({{0, 2}, {1, 2}}, 6));
  EXPECT_FALSE(basis.addEquation({{0, 1}, {1, 1}}, 4));
  basis.finish();
  EXPECT_EQ(basis.freeCount(), 1);
}

TEST(ConstraintBasis, fixedPointOfAQuarterTurnIsHalved) {
  // p = R p + t: u = -v + s, v = u + t
  ConstraintBasis basis(4);  // s, t, u, v
  EXPECT_TRUE(basis.addEquation({{2, 1}, {3, 1}, {0, -1}}, 0));
  EXPECT_TRUE(basis.addEquation({{3, 1}, {2, -1}, {1, -1}}, 0));
  basis.finish();
  ASSERT_EQ(basis.freeCount(), 2);
  Eigen::VectorXd z(2);
  z << 0.30001, 1.7;
  const auto x = basis.evaluateExact(z, 30);
  EXPECT_EQ(x[2] + x[3], x[0]);
  EXPECT_EQ(x[3] - x[2], x[1]);
}

/// As along a seam or an aligned edge; in the order that makes every variable depend on the next.
TEST(ConstraintBasis, longChainsTakeLinearTime) {
  constexpr int kLength = 200000;
  ConstraintBasis basis(kLength + 1);  // a translation, then the chain
  for (int i = kLength; i > 1; --i)
    ASSERT_TRUE(basis.addEquation({{i, 1}, {i - 1, -1}, {0, -(i % 2)}}, i % 3));
  EXPECT_FALSE(basis.addEquation({{1, 1}, {kLength, -1}, {0, kLength / 2 - 1}}, 0));
  basis.finish();
  ASSERT_EQ(basis.freeCount(), 2);
  const Eigen::VectorXd x = basis.matrix() * Eigen::Vector2d(0.25, 3) + basis.offset();
  for (int i = kLength; i > 1; --i) ASSERT_NEAR(x[i] - x[i - 1] - 0.25 * (i % 2), i % 3, 1e-9);
}

TEST(ConstraintBasis, randomSystemsHoldExactly) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const int n = 4 + int(random() % 20), equations = int(random() % n);
    ConstraintBasis basis(n);
    std::vector<std::pair<std::vector<ConstraintBasis::Term>, std::int64_t>> kept;
    for (int e = 0; e < equations; ++e) {
      std::vector<ConstraintBasis::Term> terms;
      const int count = seed % 2 == 0 ? 2 : 2 + int(random() % 2);
      for (int k = 0; k < count; ++k) terms.push_back({int(random() % n), random() % 2 ? 1 : -1});
      // Pairs give divisors 1 and 2, so that every constant is a whole number of quanta; triples can give 3.
      const std::int64_t constant = seed % 2 == 0 ? std::int64_t(random() % 5) - 2 : 0;
      if (basis.addEquation(terms, constant)) kept.emplace_back(terms, constant);
    }
    basis.finish();
    Eigen::VectorXd z = Eigen::VectorXd::Random(basis.freeCount());
    const auto exact = basis.evaluateExact(z, 24);
    const Eigen::VectorXd x = basis.matrix() * z + basis.offset();
    for (const auto& [terms, constant] : kept) {
      std::int64_t sum = 0;
      double sumX = 0;
      for (const auto& t : terms)
        sum += t.factor * exact[t.variable], sumX += double(t.factor) * x[t.variable];
      EXPECT_EQ(sum, constant << 24);
      EXPECT_NEAR(sumX, double(constant), 1e-9);
    }
    EXPECT_NEAR((basis.restrict(x) - z).norm(), 0, 1e-12);
  }
}

}  // namespace
}  // namespace trimquad
