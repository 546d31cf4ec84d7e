#include "trimquad/spline/trim_memory.h"

namespace trimquad {

ByteKey& addTo(ByteKey& key, const SplineSurface& surface) {
  for (const int n : {surface.degreeU, surface.degreeV, surface.countU, surface.countV, int(surface.closedU)})
    key.add(n);
  return key.add(surface.knotsU).add(surface.knotsV).add(surface.poles);
}

void TrimMemory::startTrim() {
  const std::lock_guard lock(mutex_);
  ++trim_;
  std::erase_if(known_, [&](const auto& item) { return item.second.trim < trim_ - kTrims; });
}

std::shared_ptr<const void> TrimMemory::find(const std::string& name) {
  const std::lock_guard lock(mutex_);
  const auto known = known_.find(name);
  if (known == known_.end()) return {};
  known->second.trim = trim_;
  return known->second.value;
}

void TrimMemory::keep(const std::string& name, std::shared_ptr<const void> value) {
  const std::lock_guard lock(mutex_);
  known_.try_emplace(name, Known{std::move(value), trim_});
}

long TrimMemory::numberOf(const SplineSurface& surface) {
  ByteKey key;
  return numberOf("surface", std::move(addTo(key, surface)));
}

long TrimMemory::numberOf(const char* step, ByteKey key) {
  return recall<long>(step, std::move(key), [&] {
    const std::lock_guard lock(mutex_);
    return numbers_++;
  });
}

}  // namespace trimquad
