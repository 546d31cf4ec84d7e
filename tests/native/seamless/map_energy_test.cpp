#include "trimquad/seamless/map_energy.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "trimquad/seamless/hessian_pattern.h"

namespace trimquad {
namespace {

/// A random basis of pairs and triples, and random triangles on its variables.
struct Problem {
  ConstraintBasis basis;
  std::vector<HessianPattern::Corners> triangles;

  Problem(unsigned seed) : basis(0) {
    std::mt19937 random(seed);
    const int variables = 6 + int(random() % 30);
    basis = ConstraintBasis(variables);
    for (int e = int(random() % 8); e > 0; --e)
      basis.addEquation({{int(random() % variables), 1},
                         {int(random() % variables), random() % 2 ? 1 : -1},
                         {int(random() % variables), 1}},
                        0);
    basis.finish();
    triangles.resize(random() % 12);
    for (auto& triangle : triangles)
      for (int& i : triangle) i = int(random() % variables);
  }
};

TEST(HessianPattern, gathersWhatTheBasisMatrixGives) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    const Problem problem(seed);
    const HessianPattern pattern(problem.basis.matrix(), problem.triangles);
    std::srand(seed);
    HessianPattern::Sum sum = pattern.start();
    const int variables = problem.basis.variableCount();
    Eigen::MatrixXd byVariables = Eigen::MatrixXd::Zero(variables, variables);
    for (size_t t = 0; t < problem.triangles.size(); ++t) {
      const Eigen::Matrix<double, 6, 6> half = Eigen::Matrix<double, 6, 6>::Random();
      const Eigen::Matrix<double, 6, 6> second = half + half.transpose();
      pattern.add(int(t), second, sum);
      for (int i = 0; i < 6; ++i)
        for (int k = 0; k < 6; ++k)
          byVariables(problem.triangles[t][i], problem.triangles[t][k]) += second(i, k);
    }
    const Eigen::SparseMatrix<double> hessian = pattern.finish(std::move(sum));
    const Eigen::MatrixXd matrix(problem.basis.matrix());
    const Eigen::MatrixXd expected = matrix.transpose() * byVariables * matrix;
    ASSERT_EQ(hessian.rows(), expected.rows());
    EXPECT_TRUE(hessian.isCompressed());
    EXPECT_LE((Eigen::MatrixXd(hessian) - expected).norm(), 1e-12 * (1 + expected.norm()));
  }
}

TEST(HessianPattern, hasEveryDiagonalAndSortedColumns) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE(seed);
    const Problem problem(seed);
    const Eigen::SparseMatrix<double> copy = HessianPattern(problem.basis.matrix(), problem.triangles).zero();
    for (int j = 0; j < copy.cols(); ++j) {
      int previous = -1;
      bool diagonal = false;
      for (Eigen::SparseMatrix<double>::InnerIterator it(copy, j); it; ++it) {
        EXPECT_LT(previous, it.row());
        previous = int(it.row());
        diagonal = diagonal || it.row() == j;
      }
      EXPECT_TRUE(diagonal);
    }
  }
}

TEST(MapDensity, derivativesAreThoseOfTheValue) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> size(0.3, 3);
  constexpr double kStep = 1e-6;
  for (const auto density : {symmetricDirichlet, straightDirichlet})
    for (int round = 0; round < 50; ++round) {
      const double D = size(random), I = 2 * D + size(random);
      const MapDensity d = density(I, D);
      const auto slope = [&](auto part, double stepI, double stepD) {
        return (part(density(I + stepI, D + stepD)) - part(density(I - stepI, D - stepD))) / (2 * kStep);
      };
      const auto value = [](const MapDensity& m) { return m.value; };
      const auto dD = [](const MapDensity& m) { return m.dD; };
      EXPECT_NEAR(d.dI, slope(value, kStep, 0), 1e-5 * (1 + std::abs(d.dI)));
      EXPECT_NEAR(d.dD, slope(value, 0, kStep), 1e-5 * (1 + std::abs(d.dD)));
      EXPECT_NEAR(d.dId, slope(dD, kStep, 0), 1e-5 * (1 + std::abs(d.dId)));
      EXPECT_NEAR(d.dDd, slope(dD, 0, kStep), 1e-5 * (1 + std::abs(d.dDd)));
    }
}

TEST(MapDensity, isLeastForIsometriesAndRisesLessForEvenScalingThanForShear) {
  const MapDensity isometry = straightDirichlet(2, 1);
  // Of the same symmetric Dirichlet energy: scaled evenly by s, and stretched by t and 1 / t.
  const double s = 1.3, energy = 2 * s * s + 2 / (s * s), x = energy / 4, t2 = x + std::sqrt(x * x - 1);
  EXPECT_NEAR(symmetricDirichlet(t2 + 1 / t2, 1).value, energy, 1e-12);
  EXPECT_GT(straightDirichlet(2 * s * s, s * s).value, isometry.value);
  EXPECT_GT(straightDirichlet(t2 + 1 / t2, 1).value, straightDirichlet(2 * s * s, s * s).value);
}

/// A twisted sheet of n x n cells, whose targets are all one triangle.
struct Sheet {
  SurfaceMesh mesh;
  MapTarget target;
  SeamGraph seams;

  explicit Sheet(int n) {
    TriangleSoup soup;
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) soup.points.push_back({double(i), double(j), 0.1 * i * j});
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const int a = i + (n + 1) * j;
        soup.triangles.push_back({a, a + 1, a + n + 2});
        soup.triangles.push_back({a, a + n + 2, a + n + 1});
      }
    mesh = buildSurfaceMesh(soup);
    for (int f = 0; f < int(mesh.n_faces()); ++f)
      target.push_back({Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 0.1), Eigen::Vector2d(0.2, 0.9)});
    seams.crossing.resize(mesh.n_halfedges());
  }
};

TEST(MapEnergy, gradientIsTheSlopeOfTheValue) {
  const Sheet sheet(4);
  const SeamBasis basis(sheet.mesh, sheet.seams, {});
  const MapEnergy energy(sheet.mesh, sheet.target, basis);
  for (unsigned seed = 1; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    std::srand(seed);
    const Eigen::VectorXd z = Eigen::VectorXd::Random(basis.basis().freeCount());
    const auto density = [](double I, double D) { return foldoverFree(I, D, 0.7); };
    Eigen::VectorXd gradient;
    Eigen::SparseMatrix<double> hessian;
    energy.derivatives(energy.coordinates(z), density, 0.3, gradient, hessian);
    const Eigen::VectorXd direction = Eigen::VectorXd::Random(z.size());
    const double h = 1e-5, slope = (energy.value(energy.coordinates(z + h * direction), density, 0.3) -
                                    energy.value(energy.coordinates(z - h * direction), density, 0.3)) /
                                   (2 * h);
    EXPECT_NEAR(gradient.dot(direction), slope, 1e-6 * (1 + std::abs(slope)));
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(Eigen::MatrixXd(hessian)).eigenvalues()[0],
              -1e-9);
  }
}

/// The distance to the target is quadratic: its Hessian is exact.
TEST(MapEnergy, hessianOfTheDistanceToTheTargetIsExact) {
  const Sheet sheet(3);
  const SeamBasis basis(sheet.mesh, sheet.seams, {});
  const MapEnergy energy(sheet.mesh, sheet.target, basis);
  const auto none = [](double, double) { return MapDensity{0, 0, 0, 0, 0}; };
  std::srand(3);
  const Eigen::VectorXd a = Eigen::VectorXd::Random(basis.basis().freeCount()),
                        b = Eigen::VectorXd::Random(basis.basis().freeCount());
  Eigen::VectorXd gradientA, gradientB;
  Eigen::SparseMatrix<double> hessian;
  energy.derivatives(energy.coordinates(a), none, 1, gradientA, hessian);
  energy.derivatives(energy.coordinates(b), none, 1, gradientB, hessian);
  EXPECT_LE((hessian * (b - a) - (gradientB - gradientA)).norm(), 1e-10 * gradientA.norm());
}

}  // namespace
}  // namespace trimquad
