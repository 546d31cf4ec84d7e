#pragma once

#include <functional>

namespace trimquad {

/// Calls `body(begin, end)` for consecutive parts of [0, count) on up to `threads` threads, the calling one
/// among them. The parts depend on `count` alone. Throws what the first part that failed threw.
void parallelParts(int count, int threads, const std::function<void(int begin, int end)>& body);

/// The same for numbers below `count`, each of which is much work: `body(number)`.
void parallelEach(int count, int threads, const std::function<void(int number)>& body);

}  // namespace trimquad
