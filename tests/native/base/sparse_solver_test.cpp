#include "trimquad/base/sparse_solver.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <chrono>
#include <cmath>
#include <cstring>
#include <random>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

using Matrix = Eigen::SparseMatrix<double>;

double uniform(std::mt19937& random) {
  return double(random()) / 4294967296.0;
}

/// Springs between random pairs of `n` points with `copies` coordinates each, which the springs couple.
Matrix randomSprings(unsigned seed, int n, int springs, int copies) {
  std::mt19937 random(seed);
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < copies * n; ++i) entries.emplace_back(i, i, 1e-3 + uniform(random));
  for (int e = 0; e < springs; ++e) {
    const int i = int(random() % n), j = int(random() % n);
    Eigen::VectorXd along(2 * copies);
    for (auto& a : along) a = uniform(random) - 0.5;
    for (int a = 0; a < 2 * copies; ++a)
      for (int b = 0; b < 2 * copies; ++b)
        entries.emplace_back(copies * (a < copies ? i : j) + a % copies,
                             copies * (b < copies ? i : j) + b % copies, along[a] * along[b]);
  }
  Matrix matrix(copies * n, copies * n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// The triangulated sheet of n x n vertices with two coupled coordinates each.
Matrix sheet(int n) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto spring = [&](int i, int j, double x, double y) {
    const double along[4] = {x, y, -x, -y};
    const int at[4] = {2 * i, 2 * i + 1, 2 * j, 2 * j + 1};
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < 4; ++b) entries.emplace_back(at[a], at[b], along[a] * along[b]);
  };
  for (int i = 0; i < 2 * n * n; ++i) entries.emplace_back(i, i, 1e-3);
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const int v = n * y + x;
      if (x + 1 < n) spring(v, v + 1, 1, 0.1);
      if (y + 1 < n) spring(v, v + n, 0.1, 1);
      if (x + 1 < n && y + 1 < n) spring(v, v + n + 1, 0.7, 0.7);
    }
  Matrix matrix(2 * n * n, 2 * n * n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

Eigen::MatrixXd randomSides(unsigned seed, Eigen::Index rows, int sides) {
  std::mt19937 random(seed);
  return Eigen::MatrixXd::NullaryExpr(rows, sides, [&] { return uniform(random) - 0.5; });
}

void expectAgreesWithOracle(SparseSolver& solver, const Matrix& matrix, int sides) {
  const Eigen::MatrixXd rhs = randomSides(7, matrix.rows(), sides);
  ASSERT_TRUE(solver.tryFactorize(matrix));
  const Eigen::SimplicialLDLT<Matrix> oracle(matrix);
  ASSERT_EQ(oracle.info(), Eigen::Success);
  const Eigen::MatrixXd mine = solver.solve(rhs), expected = oracle.solve(rhs);
  ASSERT_EQ(mine.rows(), rhs.rows());
  ASSERT_EQ(mine.cols(), rhs.cols());
  EXPECT_LE((mine - expected).norm(), 1e-8 * expected.norm());
  const Matrix full = matrix.selfadjointView<Eigen::Lower>();
  EXPECT_LE((full * mine - rhs).norm(), 1e-10 * rhs.norm() * std::max(1.0, expected.norm() / rhs.norm()));
}

TEST(SparseSolver, agreesWithSimplicialFactorisationOnRandomSystems) {
  SparseSolver reused("test");
  for (unsigned seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const int n = 1 + int(random() % 120);
    const Matrix matrix = randomSprings(seed, n, int(random() % (4 * n)), 1 + int(random() % 3));
    expectAgreesWithOracle(reused, matrix, 1 + int(random() % 3));
  }
}

TEST(SparseSolver, agreesWithSimplicialFactorisationOnASheet) {
  SparseSolver solver("test");
  for (const int n : {2, 5, 30, 90}) expectAgreesWithOracle(solver, sheet(n), 2);
}

TEST(SparseSolver, agreesWithSimplicialFactorisationOnADenseMatrix) {
  SparseSolver solver("test");
  const Eigen::MatrixXd a = randomSides(1, 150, 150);
  expectAgreesWithOracle(solver,
                         Matrix((a * a.transpose() + Eigen::MatrixXd::Identity(150, 150)).sparseView()), 3);
}

TEST(SparseSolver, readsTheLowerTriangle) {
  SparseSolver solver("test");
  expectAgreesWithOracle(solver, Matrix(sheet(12).triangularView<Eigen::Lower>()), 1);
}

TEST(SparseSolver, solvesTheEmptySystem) {
  SparseSolver solver("test");
  EXPECT_TRUE(solver.tryFactorize(Matrix(0, 0)));
  EXPECT_EQ(solver.solve(Eigen::MatrixXd(0, 2)).cols(), 2);
}

TEST(SparseSolver, tellsWhatIsNotPositiveDefinite) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const int n = 2 + int(random() % 80);
    Matrix matrix = randomSprings(seed, n, 3 * n, 2);
    SparseSolver solver("test");
    ASSERT_TRUE(solver.tryFactorize(matrix));
    const double least =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(Eigen::MatrixXd(matrix)).eigenvalues()[0];
    Matrix shifted = matrix;
    for (int i = 0; i < 2 * n; ++i) shifted.coeffRef(i, i) -= 0.999 * least;
    EXPECT_TRUE(solver.tryFactorize(shifted));
    for (int i = 0; i < 2 * n; ++i) shifted.coeffRef(i, i) -= 0.002 * least;
    EXPECT_FALSE(solver.tryFactorize(shifted));
    EXPECT_THROW(solver.factorize(shifted), Error);
    shifted.coeffRef(0, 0) = std::nan("");
    EXPECT_FALSE(solver.tryFactorize(shifted));
    expectAgreesWithOracle(solver, matrix, 1);  // a failure leaves nothing behind
  }
}

TEST(SparseSolver, singularMatrixWithAZeroColumnIsRefused) {
  std::vector<Eigen::Triplet<double>> entries{{0, 0, 1.0}, {1, 1, 1.0}};
  Matrix matrix(3, 3);
  matrix.setFromTriplets(entries.begin(), entries.end());
  EXPECT_FALSE(SparseSolver("test").tryFactorize(matrix));
}

TEST(SparseSolver, noticesAnotherPatternOfTheSameSize) {
  const auto joined = [](int i, int j) {
    Matrix matrix(4, 4);
    matrix.setIdentity();
    matrix *= 3;
    matrix.coeffRef(i, j) = matrix.coeffRef(j, i) = 1;
    matrix.makeCompressed();
    return matrix;
  };
  SparseSolver solver("test");
  expectAgreesWithOracle(solver, joined(0, 1), 1);
  expectAgreesWithOracle(solver, joined(2, 3), 1);
  expectAgreesWithOracle(solver, joined(0, 3), 1);
}

TEST(SparseSolver, sameMatrixGivesTheSameBits) {
  const Matrix matrix = sheet(40);
  const Eigen::MatrixXd rhs = randomSides(3, matrix.rows(), 1);
  SparseSolver first("test"), second("test");
  first.factorize(sheet(20));
  first.factorize(matrix);
  second.factorize(matrix);
  const Eigen::MatrixXd a = first.solve(rhs), b = second.solve(rhs);
  EXPECT_EQ(std::memcmp(a.data(), b.data(), sizeof(double) * size_t(a.size())), 0);
}

/// Translations of long seams are unknowns that thousands of others share.
TEST(SparseSolver, denseColumnsCostLittle) {
  constexpr int kSide = 224, kDense = 50, kEntries = 4000;  // 100 352 + 50 unknowns
  const Matrix grid = sheet(kSide);
  const int n = int(grid.rows());
  std::mt19937 random(5);
  std::vector<Eigen::Triplet<double>> entries;
  for (int j = 0; j < n; ++j)
    for (Matrix::InnerIterator it(grid, j); it; ++it)
      entries.emplace_back(it.row() + kDense, j + kDense, it.value());
  for (int d = 0; d < kDense; ++d)
    for (int e = 0; e < kEntries; ++e) {
      const int i = kDense + int(random() % n);
      entries.emplace_back(d, d, 1.0);
      entries.emplace_back(i, i, 1.0);
      entries.emplace_back(d, i, -0.5);
      entries.emplace_back(i, d, -0.5);
    }
  Matrix matrix(n + kDense, n + kDense);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::MatrixXd rhs = randomSides(3, matrix.rows(), 2);
  SparseSolver solver("test");
  solver.factorize(matrix);
  EXPECT_LE((matrix * solver.solve(rhs) - rhs).norm(), 1e-10 * rhs.norm());
  SupernodalPattern plain(grid), arrow(matrix);
  // 50 rows more under every column, and some loss in the order
  EXPECT_LE(double(arrow.numbers), 1.3 * double(plain.numbers) + 1.5 * kDense * double(n));
}

}  // namespace
}  // namespace trimquad
