#include "trimquad/base/dense_cholesky.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

namespace trimquad {
namespace {

Eigen::MatrixXd randomDefinite(std::mt19937& random, int n) {
  const Eigen::MatrixXd a =
      Eigen::MatrixXd::NullaryExpr(n, n, [&] { return double(random()) / 4294967296.0 - 0.5; });
  return a * a.transpose() + 0.1 * Eigen::MatrixXd::Identity(n, n);
}

TEST(DenseCholesky, eliminatesAsTheFactorOfTheWholeSays) {
  std::vector<double> scratch;
  for (unsigned seed = 0; seed < 400; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const int n = 1 + int(random() % (seed % 20 == 0 ? 400 : 90)), k = 1 + int(random() % n), below = n - k;
    const Eigen::MatrixXd matrix = randomDefinite(random, n);
    Eigen::MatrixXd panel = matrix.leftCols(k), update = matrix.bottomRightCorner(below, below);
    panel.topRows(k).triangularView<Eigen::StrictlyUpper>().setConstant(NAN);
    update.triangularView<Eigen::StrictlyUpper>().setConstant(NAN);
    ASSERT_TRUE(eliminate(panel.data(), n, k, update.data(), scratch));

    const Eigen::MatrixXd inverse = matrix.topLeftCorner(k, k).inverse();
    const Eigen::MatrixXd top = panel.topRows(k).triangularView<Eigen::Lower>();
    EXPECT_LE((top * top.transpose() - matrix.topLeftCorner(k, k)).norm(), 1e-12 * matrix.norm());
    EXPECT_LE((panel.bottomRows(below) * top.transpose() - matrix.bottomLeftCorner(below, k)).norm(),
              1e-12 * matrix.norm());
    const Eigen::MatrixXd expected =
        matrix.bottomRightCorner(below, below) -
        matrix.bottomLeftCorner(below, k) * inverse * matrix.topRightCorner(k, below);
    const Eigen::MatrixXd difference = (update - expected).triangularView<Eigen::Lower>();
    EXPECT_LE(difference.norm(), 1e-9 * matrix.norm());
  }
}

TEST(DenseCholesky, refusesANegativePivotAnywhere) {
  std::vector<double> scratch;
  for (int bad = 0; bad < 70; ++bad)
    for (const double pivot : {0.0, -1.0, double(NAN), double(INFINITY)}) {
      Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(90, 70), update = Eigen::MatrixXd::Identity(20, 20);
      matrix(bad, bad) = pivot;
      EXPECT_FALSE(eliminate(matrix.data(), 90, 70, update.data(), scratch));
    }
}

}  // namespace
}  // namespace trimquad
