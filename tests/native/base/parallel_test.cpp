#include "trimquad/base/parallel.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

namespace trimquad {
namespace {

TEST(Parallel, visitsEverythingOnce) {
  for (const int count : {0, 1, 1023, 1024, 1025, 10000})
    for (const int threads : {1, 2, 5}) {
      std::vector<int> visits(count, 0);
      parallelParts(count, threads, [&](int begin, int end) {
        for (int i = begin; i < end; ++i) ++visits[i];
      });
      EXPECT_EQ(visits, std::vector<int>(count, 1));
    }
}

TEST(Parallel, throwsWhatTheFirstPartThrew) {
  for (const int threads : {1, 3}) try {
      parallelParts(10000, threads, [](int begin, int) {
        if (begin > 0) throw std::runtime_error(std::to_string(begin));
      });
      FAIL();
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "1024");
    }
}

}  // namespace
}  // namespace trimquad
