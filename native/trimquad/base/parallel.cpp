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
  const int parts = (count + kPart - 1) / kPart;
  std::vector<std::exception_ptr> failed(parts);
  std::atomic<int> next{0};
  const auto work = [&] {
    for (int part = next++; part < parts; part = next++) try {
        body(part * kPart, std::min(count, (part + 1) * kPart));
      } catch (...) {
        failed[part] = std::current_exception();
      }
  };
  std::vector<std::thread> others;
  for (int k = 1; k < std::min(threads, parts); ++k) others.emplace_back(work);
  work();
  for (auto& thread : others) thread.join();
  for (const auto& failure : failed)
    if (failure) std::rethrow_exception(failure);
}

}  // namespace trimquad
