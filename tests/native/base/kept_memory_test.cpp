#include "trimquad/base/kept_memory.h"

#include <gtest/gtest.h>

#include <memory>
#include <thread>
#include <vector>

namespace trimquad {
namespace {

TEST(KeptMemory, mayBeAskedForSeveralTimesAtOnce) {
  auto outer = std::make_unique<KeptMemory>();
  std::vector<std::thread> threads;
  for (int k = 0; k < 4; ++k)
    threads.emplace_back([] {
      const KeptMemory inner;
      for (int i = 0; i < 20; ++i) {
        const std::vector<double> large(1 << 20, i);
        EXPECT_EQ(large.back(), i);
      }
    });
  for (auto& thread : threads) thread.join();
  outer.reset();
  const std::vector<double> after(1 << 20, 1);
  EXPECT_EQ(after.back(), 1);
}

}  // namespace
}  // namespace trimquad
