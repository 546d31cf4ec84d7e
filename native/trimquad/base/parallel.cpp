#include "trimquad/base/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>
#include <vector>

namespace trimquad {
namespace {

constexpr int kPart = 1024;

}  // namespace

void parallelParts(int count, int threads, const std::function<void(int, int)>& body) {
  parallelEach((count + kPart - 1) / kPart, threads,
               [&](int part) { body(part * kPart, std::min(count, (part + 1) * kPart)); });
}

void parallelEach(int count, int threads, const std::function<void(int)>& body) {
  std::vector<std::exception_ptr> failed(count);
  std::atomic<int> next{0};
  const auto work = [&] {
    for (int number = next++; number < count; number = next++) try {
        body(number);
      } catch (...) {
        failed[number] = std::current_exception();
      }
  };
  std::vector<std::thread> others;
  for (int k = 1; k < std::min(threads, count); ++k) others.emplace_back(work);
  work();
  for (auto& thread : others) thread.join();
  for (const auto& failure : failed)
    if (failure) std::rethrow_exception(failure);
}

}  // namespace trimquad
