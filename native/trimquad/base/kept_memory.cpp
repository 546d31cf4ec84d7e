#include "trimquad/base/kept_memory.h"

#include <cstdlib>
#include <limits>
#include <mutex>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace trimquad {
namespace {

std::mutex mutex;
int users = 0;

#ifdef __GLIBC__
void keep(bool kept) {
  // One heap for all threads that begin now: what one frees, another takes.
  mallopt(M_ARENA_MAX, kept ? 1 : 0);
  // No block of its own from the system, however large; and none back.
  constexpr int kDefaultBlocks = 65536, kDefaultTrim = 128 * 1024;
  mallopt(M_MMAP_MAX, kept ? 0 : kDefaultBlocks);
  mallopt(M_TRIM_THRESHOLD, kept ? std::numeric_limits<int>::max() : kDefaultTrim);
  constexpr int kKeptPad = 64 * 1024 * 1024, kDefaultPad = 128 * 1024;
  mallopt(M_TOP_PAD, kept ? kKeptPad : kDefaultPad);
  if (!kept) malloc_trim(0);
}
#else
void keep(bool) {}
#endif

}  // namespace

KeptMemory::KeptMemory() {
  const std::lock_guard<std::mutex> lock(mutex);
  if (users++ == 0) keep(true);
}

KeptMemory::~KeptMemory() {
  const std::lock_guard<std::mutex> lock(mutex);
  if (--users == 0) keep(false);
}

}  // namespace trimquad
