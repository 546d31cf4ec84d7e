#pragma once

#include <array>
#include <optional>
#include <vector>

#include "trimquad/base/progress.h"
#include "trimquad/field/cross_field.h"
#include "trimquad/mesh/parametrization.h"
#include "trimquad/mesh/refined_mesh.h"
#include "trimquad/mesh/region.h"
#include "trimquad/seamless/seam_basis.h"
#include "trimquad/seamless/step_budget.h"

namespace trimquad {

/// What a map should look like in each triangle: the triangle laid flat with the field along the axes, in
/// quads. By face; corners in the order of the halfedges from halfedge_handle(face) on.
using MapTarget = std::vector<std::array<Eigen::Vector2d, 3>>;

/// How a map came about.
struct MapCounters {
  int flippedBefore = 0;       ///< triangles that the Poisson solve turned over
  int pathSteps = 0;           ///< steps from a nearby map's constraints to its own
  int neighbourhoods = 0;      ///< of wrong triangles, untangled by themselves
  int untangleIterations = 0;  ///< Newton steps on the whole map until none was
  int refinements = 0;         ///< rounds of halving edges where triangles stayed turned over
  int halvedEdges = 0;         ///< in these
  int stiffenings = 0;         ///< solves in which the target weighed more where the map went wrong before
  int starts = 0;              ///< Poisson solves that untangling started from
  bool convexStart =
      false;  ///< whether untangling failed, and the map was grown from a convex (Tutte) embedding
  bool scaffolded =
      false;  ///< whether the map covered a part of the plane twice, and was grown again in a scaffold
  int iterations = 0;                             ///< Newton steps of the final optimisation
  double distortionStart = 0, distortionEnd = 0;  ///< mean symmetric Dirichlet energy, 4 for an isometry
};

/// A seamless map of a region, in units of the target edge length; exact and locally injective.
struct SeamlessMap : Parametrization {
  SeamGraph seams;
  MapTarget target;
  MapTarget conformalTarget;  ///< scaled by conformalScale()
  std::vector<AlignedSide> alignedSides;
  std::vector<int>
      index;          ///< by vertex: singularity index in quarter turns, cone angle (4 - index) * 90 degrees
  double follow = 0;  ///< weight of the distance to the target beside the distortion, as CrossField has it
  MapCounters counters;
  /// Where edges of the region had to be halved: its mesh with these, which the map is of.
  std::optional<RefinedMesh> refined;
};

/// How hard to try.
enum class Effort {
  Easy,  ///< no more than a few triangles may have to be turned back
  Full
};

/// The seamless map whose gradients follow `field`, scaled so that one quad is `edgeLength` (model units)
/// wide. Throws Error(Stage, "seamless") where no valid map was found, naming the first triangle.
SeamlessMap seamlessMap(const Region& region, const CrossField& field, double edgeLength, Effort effort,
                        StepBudget& budget, const Progress& progress);

/// The same with a budget of its own.
inline SeamlessMap seamlessMap(const Region& region, const CrossField& field, double edgeLength,
                               Effort effort, const Progress& progress) {
  StepBudget budget;
  return seamlessMap(region, field, edgeLength, effort, budget, progress);
}

}  // namespace trimquad
