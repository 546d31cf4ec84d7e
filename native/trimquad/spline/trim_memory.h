#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>

#include "trimquad/base/byte_key.h"
#include "trimquad/spline/spline_geometry.h"

namespace trimquad {

/// What the steps of trimming a model gave, so that a trim after one or two regions were fitted again repeats
/// only what these change. May be used by several threads at once.
class TrimMemory {
 public:
  /// Forgets what none of the last trims used: one that fails early uses little.
  void startTrim();
  static constexpr int kTrims = 3;

  /// What `compute()` gives, or gave before for the same step and key. Nothing is kept where it throws.
  template <class Value, class Compute>
  Value recall(const char* step, ByteKey key, const Compute& compute) {
    const std::string name = std::move(key.add(std::string(step))).bytes();
    if (const auto known = find(name)) return *std::static_pointer_cast<const Value>(known);
    auto value = std::make_shared<const Value>(compute());
    keep(name, value);
    return *value;
  }

  /// A number that stands for the surface in keys: the same for the same surface.
  long numberOf(const SplineSurface& surface);
  /// The same for anything else that a key is made of.
  long numberOf(const char* step, ByteKey key);

 private:
  std::shared_ptr<const void> find(const std::string& name);
  void keep(const std::string& name, std::shared_ptr<const void> value);

  struct Known {
    std::shared_ptr<const void> value;
    int trim;  ///< in which it was used last
  };
  std::mutex mutex_;
  std::unordered_map<std::string, Known> known_;
  int trim_ = 0;
  long numbers_ = 0;
};

ByteKey& addTo(ByteKey& key, const SplineSurface& surface);

}  // namespace trimquad
