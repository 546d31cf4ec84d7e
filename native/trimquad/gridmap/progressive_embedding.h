#pragma once

#include <optional>
#include <vector>

#include "trimquad/base/fixed.h"
#include "trimquad/gridmap/patch_disk.h"

namespace trimquad {

/// A one to one map of the disk with its rim vertices where they are given, for disks whose convex
/// combination maps shrink beyond all numbers: in a long and narrow part they do so exponentially. Inner
/// vertices are taken out one by one, what is left is mapped, and they are put back in one by one, each into
/// the kernel of its neighbours, while the triangles are kept in shape. (After Shen, Jiang, Zorin and Panozzo
/// 2019) \return by vertex of the disk; every triangle is positive, exactly. None where a vertex finds no
/// room in whole quanta
std::optional<std::vector<FixedVector>> progressiveEmbedding(const PatchDisk& disk,
                                                             const std::vector<FixedVector>& rim,
                                                             FixedScale scale);

}  // namespace trimquad
