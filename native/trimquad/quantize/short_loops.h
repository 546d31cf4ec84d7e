#pragma once

#include "trimquad/base/progress.h"
#include "trimquad/quantize/objective.h"
#include "trimquad/quantize/separation.h"

namespace trimquad {

/// Lengthens arcs until the grid has no edge from a point to itself, no two edges between the same two points
/// and no two quads with the same corners: around a thin handle, neck or hole there are three quads at least.
/// With fewer, a grid map exists all the same, but its quads, which only know their corners, are no surface.
/// Nothing becomes shorter; the lengths stay consistent and separating, and the objective rises as little as
/// single circuits allow. What lies beyond free boundaries does not count. Lengths stay as they were where
/// that does not end: no loop around a vertex of a single quad becomes longer. \return how often arcs were
/// lengthened
int widenLoops(const Dual& dual, const Objective& objective, const SeparationTest& separation, ArcLengths& q,
               const Progress& progress);

/// Such edges and quads, each as a fault that stays as long as the arcs of all patches around its points keep
/// their lengths.
std::vector<Collapse> shortLoopFaults(const TMesh& tmesh, const ArcLengths& q);

/// Whether there are any.
bool hasShortLoops(const TMesh& tmesh, const ArcLengths& q);

}  // namespace trimquad
