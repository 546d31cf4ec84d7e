// Random surfaces, most of them on coarse lattices where everything coincides that can.

#include "support/random_surfaces.h"
#include "support/rounds.h"
#include "support/tmesh_checks.h"

using namespace trimquad;
using namespace trimquad::samples;

namespace {

/// Adds the types that occur. Aligned edges and feature points are put in at random as well.
void checkRandom(unsigned seed, GridMap (*make)(std::mt19937&), std::map<int, int>& types) {
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  GridMap map = make(random);
  if (random() % 2 == 0) alignSome(map, 1 + random() % 4, random);
  if (random() % 3 == 0) markSome(map, 2 + random() % 20, random);
  shuffleSeamlessCharts(map, random);
  try {
    for (const auto& [type, count] : typesOf(soundPartition(map))) types[type] += count;
  } catch (const std::exception& error) {
    ADD_FAILURE() << error.what();
  }
}

}  // namespace

TEST(RandomPartition, everyDomainIsCutIntoRectangles) {
  std::map<int, int> types;
  for (unsigned seed = 0; seed < sample::rounds(3000) && !testing::Test::HasFailure(); ++seed)
    checkRandom(seed, randomDomain, types);
  if (sample::rounds(3000) == 3000) {
    EXPECT_EQ(types.size(), 13u);
  }
}

TEST(RandomPartition, everySingularSurfaceIsCutIntoRectangles) {
  std::map<int, int> types;
  for (unsigned seed = 0; seed < sample::rounds(750) && !testing::Test::HasFailure(); ++seed)
    checkRandom(seed, randomSingularSurface, types);
  if (sample::rounds(750) == 750) {
    EXPECT_EQ(types.size(), 13u);
  }
}

TEST(RandomPartition, turnedDomainsWithHoles) {
  std::map<int, int> types;
  for (unsigned seed = 0; seed < sample::rounds(400) && !testing::Test::HasFailure(); ++seed)
    checkRandom(
        seed,
        [](std::mt19937& random) {
          const int n = 3 + int(random() % 14);
          const Eigen::Rotation2Dd turned(2 * M_PI * double(random() % 1000) / 1000);
          const auto soup = sheet(n, n, [&](int i, int j) -> Eigen::Vector2d {
            return turned * Eigen::Vector2d(i + 0.2 * std::sin(3.0 * j), j + 0.2 * std::cos(2.0 * i));
          });
          MappedSoup mapped{soup, {}};
          for (const auto& t : soup.triangles)
            mapped.corners.push_back(
                {soup.points[t[0]].head<2>(), soup.points[t[1]].head<2>(), soup.points[t[2]].head<2>()});
          return gridMapOf(pierced(mapped, int(random() % 60), random), 30);
        },
        types);
}
