#include "trimquad/quantize/quantize.h"

#include "tmesh/random_surfaces.h"
#include "tmesh/tmesh_checks.h"

using namespace trimquad;
using namespace trimquad::samples;

namespace {

GridMap randomMap(unsigned seed) {
  std::mt19937 random(seed);
  GridMap map = random() % 2 == 0 ? randomDomain(random) : randomSingularSurface(random);
  if (random() % 2 == 0) alignSome(map, 1 + random() % 4, random);
  if (random() % 3 == 0) markSome(map, 2 + random() % 20, random);
  // From quads much larger than the surface to much smaller ones: the same map in another unit.
  map.scale.bits += int(random() % 9) - 4;
  return map;
}

}  // namespace

TEST(Quantize, randomSurfaces) {
  const Progress progress;
  for (unsigned seed = 0; seed < 400 && !testing::Test::HasFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const TMesh tmesh = partition(randomMap(seed), progress);
    const Quantization greedy = quantize(tmesh, {}, progress);
    QuantizationOptions options;
    options.optimal = tmesh.arcs.size() < 60;
    const Quantization optimal = quantize(tmesh, options, progress);
    printf("seed %u arcs %zu greedy %.6g %s %.6g bound %.6g zero %d/%d\n", seed, tmesh.arcs.size(), greedy.objective, optimal.method.c_str(), optimal.objective, optimal.lowerBound.value_or(0), greedy.zeroArcs, greedy.zeroPatches);
    fflush(stdout);
    EXPECT_LE(optimal.objective, greedy.objective + 1e-6);
    EXPECT_LE(optimal.lowerBound.value_or(0), optimal.objective + 1e-6);
  }
}
