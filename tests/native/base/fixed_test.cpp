#include "trimquad/base/fixed.h"

#include <gtest/gtest.h>

#include <random>

namespace trimquad {
namespace {

TEST(Fixed, orientationIsExactAtTheEndOfTheRange) {
  const Quanta big = (Quanta(1) << 43) - 1;
  EXPECT_EQ(orientation({-big, -big}, {big, big}, {big - 1, big}), 1);
  EXPECT_EQ(orientation({-big, -big}, {big, big}, {big, big - 1}), -1);
  EXPECT_EQ(orientation({-big, -big}, {0, 0}, {big, big}), 0);
}

TEST(Fixed, quarterTurnsFormAGroup) {
  std::mt19937 random(7);
  std::uniform_int_distribution<Quanta> value(-1000, 1000);
  for (int i = 0; i < 1000; ++i) {
    const Transition a{int(random() % 4), {value(random), value(random)}},
        b{int(random() % 4), {value(random), value(random)}};
    const FixedVector x{value(random), value(random)};
    EXPECT_EQ(a.after(b)(x), a(b(x)));
    EXPECT_EQ(a.inverse()(a(x)), x);
    EXPECT_TRUE(a.after(a.inverse()).isIdentity());
  }
}

TEST(Fixed, crossingsAlongAnEdgeAreOrderedExactly) {
  const FixedVector a{0, 0}, b{3, 7};
  EXPECT_LT(compareCrossings(a, b, 0, 1, 1, 3), 0);  // 1/3 < 3/7
  EXPECT_GT(compareCrossings(a, b, 0, 2, 1, 4), 0);  // 2/3 > 4/7
  EXPECT_EQ(compareCrossings(a, {4, 8}, 0, 1, 1, 2), 0);
  EXPECT_GT(compareCrossings(b, a, 0, 1, 1, 3), 0);
}

TEST(Fixed, sectorsBeyondHalfATurn) {
  const FixedVector e{1, 0}, n{0, 1}, w{-1, 0}, s{0, -1};
  EXPECT_TRUE(strictlyInsideSector(e, w, n));
  EXPECT_FALSE(strictlyInsideSector(e, w, s));
  EXPECT_FALSE(strictlyInsideSector(e, n, e));
  EXPECT_FALSE(strictlyInsideSector(e, n, n));
  EXPECT_TRUE(strictlyInsideSector(e, s, n));
  EXPECT_TRUE(strictlyInsideSector(e, s, w));
  EXPECT_FALSE(strictlyInsideSector(e, s, s));
  EXPECT_FALSE(strictlyInsideSector(e, s, e));
  EXPECT_FALSE(strictlyInsideSector(e, s, {1, -1}));
  EXPECT_TRUE(strictlyInsideSector(e, {1, -1}, {-5, -3}));
  EXPECT_TRUE(strictlyInsideSector(e, e, {1, -1}));
  EXPECT_FALSE(strictlyInsideSector(e, e, {2, 0}));
}

TEST(Fixed, sectorsAgreeWithAngles) {
  std::mt19937 random(11);
  std::uniform_int_distribution<Quanta> value(-3, 3);
  const auto draw = [&] {
    for (;;) {
      const FixedVector d{value(random), value(random)};
      if (d != FixedVector{}) return d;
    }
  };
  const auto turn = [](FixedVector from, FixedVector to) {
    double a = std::atan2(double(to.v), double(to.u)) - std::atan2(double(from.v), double(from.u));
    while (a <= 1e-9) a += 2 * M_PI;
    return a;
  };
  for (int i = 0; i < 20000; ++i) {
    const FixedVector from = draw(), to = draw(), d = draw();
    const double end = turn(from, to), at = turn(from, d);
    if (std::abs(end - at) < 1e-6 || std::abs(at - 2 * M_PI) < 1e-6) {
      EXPECT_FALSE(strictlyInsideSector(from, to, d));
    } else {
      EXPECT_EQ(strictlyInsideSector(from, to, d), at < end)
          << from.u << "," << from.v << " " << to.u << "," << to.v << " " << d.u << "," << d.v;
    }
  }
}

TEST(Fixed, scaleKeepsCoordinatesBelow44Bits) {
  for (const double largest : {0.0, 0.7, 1.0, 3.5, 100.0, 12345.6, 1e6}) {
    const auto scale = FixedScale::fitting(largest);
    EXPECT_LT(std::abs(scale.round(largest)), Quanta(1) << 44);
    EXPECT_GE(scale.bits, 20);
  }
}

}  // namespace
}  // namespace trimquad
