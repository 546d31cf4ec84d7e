#pragma once

namespace trimquad::sample {

/// How many random inputs a test takes: `full` of them, a twentieth where sanitizers slow each one down.
constexpr unsigned rounds(unsigned full) {
#if defined(__SANITIZE_ADDRESS__)
  return full / 20 > 4 ? full / 20 : 4;
#else
  return full;
#endif
}

}  // namespace trimquad::sample
