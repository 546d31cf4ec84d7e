#pragma once

namespace trimquad::sample {

/// Whether sanitizers make everything twenty times slower.
#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

/// How many random inputs a test takes: `full` of them, a twentieth where sanitizers slow each one down.
constexpr unsigned rounds(unsigned full) {
  if (!kSanitized) return full;
  return full / 20 > 4 ? full / 20 : 4;
}

/// Triangles along a side of an input: `full` of them, three fifths where sanitizers slow down each.
constexpr int fineness(int full) {
  return kSanitized ? full * 3 / 5 : full;
}

}  // namespace trimquad::sample
