#include "trimquad/field/bridged_guidance.h"

#include "trimquad/base/error.h"

namespace trimquad {

FieldGuidance overBridges(const FieldGuidance& guidance, const Region& region) {
  if (region.bridge.empty()) return guidance;
  FieldGuidance result;
  std::size_t next = 0;
  for (const bool bridges : region.bridge) {
    TRIMQUAD_ASSERT(bridges || next < guidance.weight.size());
    result.direction.push_back(bridges ? Eigen::Vector3d(0, 0, 0) : guidance.direction[next]);
    result.weight.push_back(bridges ? 0 : guidance.weight[next]);
    if (!bridges) ++next;
  }
  TRIMQUAD_ASSERT(next == guidance.weight.size());
  return result;
}

FieldGuidance offBridges(const FieldGuidance& guidance, const Region& region) {
  if (region.bridge.empty()) return guidance;
  TRIMQUAD_ASSERT(guidance.weight.size() == region.bridge.size());
  FieldGuidance result;
  for (std::size_t f = 0; f < region.bridge.size(); ++f)
    if (!region.bridge[f]) {
      result.direction.push_back(guidance.direction[f]);
      result.weight.push_back(guidance.weight[f]);
    }
  return result;
}

}  // namespace trimquad
