#include "trimquad/brep/face_checks.h"

// Before OpenCASCADE, whose macro Handle() breaks OpenMesh.
#include "support/trim_samples.h"

#include <gtest/gtest.h>

namespace trimquad {
namespace {

using namespace test;

const Progress unwatched;

FaceChecks checksOf() {
  return FaceChecks(TRIMQUAD_CHECKER);
}

using Faults = std::vector<std::vector<FaceFault>>;

/// A box of which two faces are left, one with a spike, away from its edges, through the middle of the other.
SplineModel spikedFaces() {
  auto model = bulgedBox(0.8, {1, 5}).trim();
  const auto middle = [](const SplineSurface& s) -> Eigen::Vector3d {
    return s.point((s.firstU() + s.lastU()) / 2, (s.firstV() + s.lastV()) / 2);
  };
  const Eigen::Vector3d across = middle(model.faces[0].surface) - middle(model.faces[1].surface);
  auto& spiked = model.faces[1].surface;
  for (const int i : {-1, 0, 1})
    for (const int j : {-1, 0, 1})
      spiked.poles[spiked.countU / 2 + i + spiked.countU * (spiked.countV / 2 + j)] += 2 * across;
  return model;
}

TEST(FaceChecks, facesThatCrossAreFoundWhereverTheyAre) {
  auto model = spikedFaces();
  const std::vector<FaceFault> none;
  ASSERT_NE(model.faces[0].region, model.faces[1].region);
  const Faults crossing = checksOf().faults(model, {}, 1, unwatched);
  EXPECT_EQ(crossing[0].at(0).other, 1);
  EXPECT_EQ(crossing[1].at(0).other, 0);
  EXPECT_EQ(checksOf().likelyFaults(model, {}, 1, unwatched), Faults(2));
  for (const auto& folded : {std::vector<int>{}, {0}, {1}})
    for (const auto& faults : checksOf().faults(model, folded, 2, unwatched)) EXPECT_NE(faults, none);
  // Also such as are bent against each other, which are looked at before the others.
  model.faces[1].region = model.faces[0].region;
  for (const auto& faults : checksOf().likelyFaults(model, {}, 1, unwatched)) EXPECT_NE(faults, none);
}

TEST(FaceChecks, aFaceThatCrossesItselfIsFound) {
  auto model = bulgedBox(0.8, {5}).trim();
  EXPECT_EQ(checksOf().faults(model, {}, 1, unwatched), Faults(1));
  // A loop, away from the edges.
  const std::vector<Eigen::Vector3d> loop{{2.2, 0, 0}, {2.5, 0, 3}, {-3.2, 0, 3}, {-3.9, 0, -2}};
  auto& s = model.faces[0].surface;
  for (int j = s.countV / 3; j <= 2 * s.countV / 3; ++j)
    for (int i = 0; i < 4; ++i) s.poles[s.countU / 2 - 1 + i + s.countU * j] += loop[i];
  const Faults crossing = checksOf().faults(model, {}, 1, unwatched);
  ASSERT_FALSE(crossing[0].empty());
  EXPECT_FALSE(crossing[0][0].other);
}

TEST(FaceChecks, bodiesMayCrossEachOther) {
  auto model = spikedFaces();
  model.shells = {{{0}, {}, 0}, {{1}, {}, 1}};
  EXPECT_EQ(checksOf().faults(model, {}, 1, unwatched), Faults(2));
  // Two shells of one solid may not.
  model.shells[1].body = 0;
  EXPECT_NE(checksOf().faults(model, {}, 1, unwatched), Faults(2));
}

TEST(FaceChecks, theFileOfTheModelIsCheckedAsAWhole) {
  auto model = bulgedBox(0.8).trim();
  EXPECT_EQ(checksOf().faultsOfWhole(model, unwatched), std::vector<std::string>{});
  for (auto& pole : model.edges[0].curve.poles) pole[2] += 1e-2;
  EXPECT_NE(checksOf().faultsOfWhole(model, unwatched), std::vector<std::string>{});
}

TEST(FaceChecks, findAgainWhatIsStillThereAndWhatIsNew) {
  auto model = bulgedBox(0.8).trim();
  auto checks = checksOf();
  const Faults none(model.faces.size());
  EXPECT_EQ(checks.faults(model, {}, 2, unwatched), none);
  auto bent = model;
  for (auto& pole : bent.edges[0].curve.poles) pole[2] += 1e-2;
  const Faults found = checks.faults(bent, {}, 2, unwatched);
  EXPECT_NE(found, none);
  EXPECT_EQ(checks.faults(bent, {}, 1, unwatched), found);
  EXPECT_EQ(checksOf().faults(bent, {}, 1, unwatched), found);
  EXPECT_EQ(checks.faults(model, {}, 1, unwatched), none);
  // The vertices count as well.
  auto loose = model;
  loose.vertices[0].point[0] += 1e-2;
  EXPECT_NE(checks.faults(loose, {}, 1, unwatched), none);
}

}  // namespace
}  // namespace trimquad
