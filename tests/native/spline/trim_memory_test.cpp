#include "trimquad/spline/trim_memory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace trimquad {
namespace {

struct Counted {
  TrimMemory memory;
  int computed = 0;
  int of(int key, const char* step = "step") {
    return memory.recall<int>(step, ByteKey().add(key), [&] { return ++computed, 10 * key; });
  }
};

TEST(TrimMemory, computesOncePerStepAndKey) {
  Counted c;
  c.memory.startTrim();
  EXPECT_EQ(c.of(1), 10);
  EXPECT_EQ(c.of(1), 10);
  EXPECT_EQ(c.of(2), 20);
  EXPECT_EQ(c.computed, 2);
  c.of(1, "another");
  EXPECT_EQ(c.computed, 3);
}

TEST(TrimMemory, forgetsWhatTheLastTrimsDidNotUse) {
  Counted c;
  c.memory.startTrim();
  c.of(1);
  c.of(2);
  for (int trim = 0; trim < TrimMemory::kTrims; ++trim) {
    c.memory.startTrim();
    c.of(1);
  }
  EXPECT_EQ(c.computed, 2);
  c.memory.startTrim();
  c.of(1);
  EXPECT_EQ(c.computed, 2);
  c.of(2);
  EXPECT_EQ(c.computed, 3);
}

TEST(TrimMemory, keepsNothingThatFailed) {
  TrimMemory memory;
  const auto fail = []() -> int { throw std::runtime_error("no"); };
  EXPECT_THROW(memory.recall<int>("step", ByteKey().add(1), fail), std::runtime_error);
  EXPECT_EQ(memory.recall<int>("step", ByteKey().add(1), [] { return 7; }), 7);
}

TEST(TrimMemory, numbersStandForSurfaces) {
  TrimMemory memory;
  SplineSurface surface;
  surface.knotsU = surface.knotsV = {0, 0, 0, 0, 1, 1, 1, 1};
  surface.countU = surface.countV = 4;
  surface.poles.assign(16, Eigen::Vector3d(1, 2, 3));
  SplineSurface other = surface;
  other.poles[5][1] = std::nextafter(2.0, 3.0);
  const long number = memory.numberOf(surface);
  EXPECT_NE(memory.numberOf(other), number);
  EXPECT_EQ(memory.numberOf(surface), number);
}

}  // namespace
}  // namespace trimquad
