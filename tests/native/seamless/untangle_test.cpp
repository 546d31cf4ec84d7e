#include "trimquad/seamless/untangle.h"

#include <gtest/gtest.h>

#include <memory>
#include <numbers>
#include <random>

#include "support/rounds.h"
#include "support/sample_regions.h"
#include "trimquad/seamless/neighbourhoods.h"
#include "trimquad/seamless/seed.h"
#include "trimquad/seamless/solve_map.h"
#include "trimquad/seamless/winding.h"

namespace trimquad {
namespace {

/// A map that the tests fold.
struct Sample {
  Region region;
  SeamlessMap map;
  std::unique_ptr<SeamBasis> basis;
  std::unique_ptr<MapEnergy> energy;
  Eigen::VectorXd flat;  ///< without flipped triangles

  explicit Sample(const TriangleSoup& soup) : region(sample::region(soup)) {
    SeedOptions options;
    options.edgeLength = std::sqrt(surfaceArea(region.mesh) / 1000);
    map = seed(region, options, Progress()).map;
    basis = std::make_unique<SeamBasis>(region.mesh, map.seams, SeamConstraints{});
    energy = std::make_unique<MapEnergy>(region.mesh, map.target, *basis);
    flat = poissonMap(region.mesh, map.target, *basis);
    EXPECT_EQ(flippedIn(flat), 0);
  }

  int flippedIn(const Eigen::VectorXd& z) const { return energy->flipped(energy->coordinates(z)); }
  WrongTriangles turnedOver() const {
    return [this](const Eigen::VectorXd& z) { return energy->turnedOver(energy->coordinates(z)); };
  }
  double triangleSize() const { return std::sqrt(1000.0 / double(region.mesh.n_faces())); }
  int unknown(VertexHandle v, int axis) const {
    HalfedgeHandle h = region.mesh.halfedge_handle(v);
    if (region.mesh.is_boundary(h))
      h = region.mesh.opposite_halfedge_handle(region.mesh.prev_halfedge_handle(h));
    const int variable = basis->coordinate(basis->wedge(h), axis);
    for (int i = 0; i < basis->basis().freeCount(); ++i)
      if (basis->basis().freeVariable(i) == variable) return i;
    ADD_FAILURE() << "vertex " << v.idx() << " is not free";
    return 0;
  }
  Eigen::VectorXd noisy(double size, std::mt19937& random) const {
    std::normal_distribution<double> noise(0, size * triangleSize());
    Eigen::VectorXd z = flat;
    for (double& x : z) x += noise(random);
    return z;
  }
};

/// A torus with bumps, whose map has singular vertices: 4 n x 2 n cells.
TriangleSoup bumpyTorus(int n) {
  TriangleSoup soup;
  const int around = 4 * n, across = 2 * n;
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      const double a = 2 * std::numbers::pi * i / around, b = 2 * std::numbers::pi * j / across,
                   thickness = 1 + 0.35 * std::sin(3 * a) * std::sin(2 * b), r = 3 + thickness * std::cos(b);
      soup.points.emplace_back(r * std::cos(a), r * std::sin(a), thickness * std::sin(b));
    }
  const auto at = [&](int i, int j) { return i % around * across + j % across; };
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      soup.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      soup.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return soup;
}

TEST(FoldoverFree, hasItsLeastForASimilarityOfPositiveAreaOnlyWhereEpsilonIsSmall) {
  const auto ofSimilarity = [](double D, double epsilon) { return foldoverFree(2 * D, D, epsilon).value; };
  for (const double epsilon : {0.05, 0.3, 0.5}) {
    const double D = (1 + std::sqrt(4 - 12 * epsilon * epsilon)) / 3;
    EXPECT_LT(ofSimilarity(D, epsilon), ofSimilarity(D - 0.01, epsilon));
    EXPECT_LT(ofSimilarity(D, epsilon), ofSimilarity(D + 0.01, epsilon));
  }
  for (const double epsilon : {0.58, 1.0, 5.0})
    for (double D = 0; D < 2; D += 0.01)
      EXPECT_LT(ofSimilarity(D, epsilon), ofSimilarity(D + 0.01, epsilon)) << epsilon;
}

/// The flipped triangles that untangling leaves of a map that is moved at random.
int leftOf(const Sample& sample, double noise, unsigned seed) {
  std::mt19937 random(seed);
  Eigen::VectorXd z = sample.noisy(noise, random);
  const auto wrong = [&](const Eigen::VectorXd& map) {
    return wrongTriangles(sample.region.mesh, sample.map.index, *sample.basis, *sample.energy,
                          sample.energy->coordinates(map));
  };
  EXPECT_GT(wrong(z).size(), 20u);
  MapCounters counters;
  StepBudget budget;
  SparseSolver solver("test");
  untangle(*sample.energy, wrong, z, counters, solver, budget, Progress());
  return sample.flippedIn(z);
}

TEST(Untangling, foldsAtRandomPlacesOfASurfaceWithSingularitiesAreTurnedBack) {
  const Sample torus(bumpyTorus(12));
  ASSERT_TRUE(std::any_of(torus.map.index.begin(), torus.map.index.end(), [](int i) { return i != 0; }));
  for (unsigned seed = 1; seed <= sample::rounds(40); ++seed) EXPECT_EQ(leftOf(torus, 0.3, seed), 0) << seed;
}

TEST(Untangling, foldsEverywhereAreTurnedBack) {
  // A sixth of the triangles; the places where all of them at once get stuck start anew.
  const Sample torus(bumpyTorus(12));
  int seeds = 0, stuck = 0;
  for (unsigned seed = 1; seed <= sample::rounds(40); ++seed, ++seeds) stuck += leftOf(torus, 0.6, seed) > 0;
  EXPECT_LE(stuck, seeds / 20);
}

TEST(Untangling, whatIsFarFromFoldsStaysWhereItIs) {
  const Sample sheet(sample::sheet(30, 30, sample::wavy));
  const auto at = [](int i, int j) { return VertexHandle(i + 31 * j); };
  Eigen::VectorXd z = sheet.flat;
  z[sheet.unknown(at(8, 8), 0)] += 3 * sheet.triangleSize();
  ASSERT_GT(sheet.flippedIn(z), 0);
  const Eigen::VectorXd folded = z;
  MapCounters counters;
  StepBudget budget;
  SparseSolver solver("test");
  untangle(*sheet.energy, sheet.turnedOver(), z, counters, solver, budget, Progress());
  EXPECT_EQ(sheet.flippedIn(z), 0);
  EXPECT_EQ(counters.neighbourhoods, 1);
  EXPECT_EQ(counters.untangleIterations, 0);
  EXPECT_NE(z, folded);
  for (const auto v : sheet.region.mesh.vertices()) {
    if (v.idx() % 31 < 20 || v.idx() / 31 < 20) continue;
    for (int axis = 0; axis < 2; ++axis) {
      const int i = sheet.unknown(v, axis);
      EXPECT_EQ(z[i], folded[i]);
    }
  }
}

TEST(Untangling, foldsFarFromEachOtherDoNotKnowOfEachOther) {
  const Sample sheet(sample::sheet(40, 40, sample::wavy));
  const auto at = [](int i, int j) { return VertexHandle(i + 41 * j); };
  const int one = sheet.unknown(at(9, 9), 0), other = sheet.unknown(at(31, 30), 1);
  const auto untangled = [&](double first, double second) {
    Eigen::VectorXd z = sheet.flat;
    z[one] += first * sheet.triangleSize();
    z[other] += second * sheet.triangleSize();
    int kept = 0;
    StepBudget budget;
    untangleNeighbourhoods(*sheet.energy, sheet.turnedOver(), z, kept, budget, Progress());
    EXPECT_EQ(kept, (first != 0) + (second != 0));
    EXPECT_EQ(sheet.flippedIn(z), 0);
    return z;
  };
  const Eigen::VectorXd both = untangled(2.5, 4), first = untangled(2.5, 0), second = untangled(0, 4);
  for (int i = 0; i < both.size(); ++i) EXPECT_TRUE(both[i] == first[i] || both[i] == second[i]);
  EXPECT_EQ(both[one], first[one]);
  EXPECT_EQ(both[other], second[other]);
}

TEST(Untangling, whatStaysWrongIsUntangledAsAWhole) {
  const Sample sheet(sample::sheet(20, 20, sample::wavy));
  Eigen::VectorXd z = sheet.flat;
  z[sheet.unknown(VertexHandle(5 + 21 * 5), 0)] += 3 * sheet.triangleSize();
  MapCounters counters;
  StepBudget budget;
  SparseSolver solver("test");
  const auto always = [](const Eigen::VectorXd&) { return std::vector<FaceHandle>{FaceHandle(200)}; };
  untangle(*sheet.energy, always, z, counters, solver, budget, Progress());
  EXPECT_GT(counters.untangleIterations, 0);
  EXPECT_EQ(sheet.flippedIn(z), 0);
}

TEST(Untangling, aSpentBudgetIsNotLookedIntoAnyFurther) {
  const Sample sheet(sample::sheet(20, 20, sample::wavy));
  Eigen::VectorXd z = sheet.flat;
  StepBudget budget = StepBudget::ofWork(1e6);
  budget.spend(2e6);
  int kept = 0, looks = 0;
  const auto counted = [&](const Eigen::VectorXd&) {
    return ++looks, std::vector<FaceHandle>{FaceHandle(200)};
  };
  untangleNeighbourhoods(*sheet.energy, counted, z, kept, budget, Progress());
  EXPECT_EQ(kept + looks, 0);
  EXPECT_EQ(z, sheet.flat);
}

TEST(Neighbourhoods, areAllThatTheirUnknownsMove) {
  const Sample torus(bumpyTorus(10));
  const MapEnergy& energy = *torus.energy;
  const Neighbourhoods neighbourhoods(energy);
  std::vector<std::vector<int>> unknownsOf;
  for (int f = 0; f < energy.faceCount(); ++f) unknownsOf.push_back(energy.unknownsOf(f));
  for (unsigned number = 1; number <= 10; ++number) {
    SCOPED_TRACE(number);
    std::mt19937 random(number);
    std::vector<FaceHandle> faces;
    for (int k = 0; k < 8; ++k) faces.emplace_back(int(random() % unsigned(energy.faceCount())));
    std::vector<int> partOfFace(energy.faceCount(), -1), partOfUnknown(energy.unknownCount(), -1);
    const auto parts = neighbourhoods.around(faces, 3);
    for (int p = 0; p < int(parts.size()); ++p) {
      for (const int f : parts[p].faces) {
        EXPECT_EQ(partOfFace[f], -1) << "shared by two";
        partOfFace[f] = p;
      }
      for (const int unknown : parts[p].unknowns) partOfUnknown[unknown] = p;
    }
    for (const auto f : faces) EXPECT_GE(partOfFace[f.idx()], 0);
    for (int f = 0; f < energy.faceCount(); ++f)
      for (const int unknown : unknownsOf[f])
        if (partOfUnknown[unknown] >= 0) {
          EXPECT_EQ(partOfFace[f], partOfUnknown[unknown]);
        }
  }
}

TEST(Neighbourhoods, crossSeams) {
  // Everything but the seams' translations is within reach of one triangle.
  const Sample torus(bumpyTorus(8));
  const auto parts = Neighbourhoods(*torus.energy).around({FaceHandle(0)}, 100);
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_EQ(int(parts[0].faces.size()), torus.energy->faceCount());
  EXPECT_GE(int(parts[0].unknowns.size()), torus.energy->unknownCount() - 2 * torus.basis->branchCount());
}

TEST(MapEnergy, ofANeighbourhoodChangesAsTheWholeDoes) {
  const Sample torus(bumpyTorus(8));
  const MapEnergy& energy = *torus.energy;
  std::mt19937 random(2);
  const Eigen::VectorXd z = torus.noisy(0.4, random);
  const auto density = [](double I, double D) { return foldoverFree(I, D, 0.2); };
  Eigen::VectorXd gradient, partGradient;
  Eigen::SparseMatrix<double> hessian, partHessian;
  energy.derivatives(energy.coordinates(z), density, 0.3, gradient, hessian);
  for (const auto& [faces, unknowns] :
       Neighbourhoods(energy).around({FaceHandle(10), FaceHandle(300), FaceHandle(700)}, 2)) {
    const MapEnergy part = energy.restricted(faces, unknowns, z);
    const Eigen::VectorXd mine = z(unknowns);
    part.derivatives(part.coordinates(mine), density, 0.3, partGradient, partHessian);
    EXPECT_LE((gradient(unknowns) - partGradient).norm(), 1e-9 * partGradient.norm());
    for (int i = 0; i < int(unknowns.size()); ++i)
      for (int j = 0; j < int(unknowns.size()); ++j)
        EXPECT_NEAR(hessian.coeff(unknowns[i], unknowns[j]), partHessian.coeff(i, j),
                    1e-9 * partHessian.norm());
    for (size_t k = 0; k < faces.size(); ++k) {
      const double whole = energy.jacobian(faces[k], energy.coordinates(z)).det();
      EXPECT_NEAR(part.jacobian(int(k), part.coordinates(mine)).det(), whole, 1e-9 * (1 + std::abs(whole)));
    }
  }
}

TEST(StepBudget, countsAllThatWasSpentWhateverIsPutAside) {
  StepBudget budget;
  budget.spend(4e9);
  const double aside = budget.setAside(0.5);
  budget.spend(4e9);
  budget.add(aside);
  EXPECT_EQ(budget.steps(), 4000000);
}

}  // namespace
}  // namespace trimquad
