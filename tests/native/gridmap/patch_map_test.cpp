#include "trimquad/gridmap/patch_map.h"
#include "support/rounds.h"

#include "support/random_surfaces.h"
#include "support/tmesh_checks.h"
#include "trimquad/embed/embed.h"

using namespace trimquad;
using namespace trimquad::samples;

namespace {

GridMap randomMap(unsigned seed) {
  std::mt19937 random(seed);
  GridMap map = random() % 2 == 0 ? randomDomain(random) : randomSingularSurface(random);
  if (random() % 2 == 0) alignSome(map, 1 + random() % 4, random);
  if (random() % 3 == 0) markSome(map, 2 + random() % 20, random);
  map.scale.bits += int(random() % 9) - 4;  // the same map in another unit
  return map;
}

PatchMap patchMapOf(const Parametrization& map) {
  const Progress progress;
  const TMesh tmesh = partition(map, progress);
  return constructiveMap(map, embed(map, tmesh, quantize(tmesh, {}, progress), progress), progress);
}

}  // namespace

TEST(PatchMap, randomSurfacesGetValidGridMaps) {
  int uniform = 0;
  for (unsigned seed = 0; seed < sample::rounds(150) && !testing::Test::HasFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const GridMap map = randomMap(seed);
    try {
      const PatchMap result = patchMapOf(map);
      verify(result.map, true);
      // The cones are those of the map.
      const auto before = coneQuarters(map), after = coneQuarters(result.map);
      for (std::size_t v = 0; v < after.size(); ++v)
        EXPECT_EQ(after[v], v < before.size() ? before[v]
                                              : (result.map.mesh.is_boundary(VertexHandle(int(v))) ? 0 : 4));
      uniform += result.uniform;
    } catch (const std::exception& error) {
      ADD_FAILURE() << error.what();
    }
  }
}
