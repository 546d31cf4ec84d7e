#pragma once

#include <optional>
#include <string>

#include "trimquad/field/cross_field.h"
#include "trimquad/seamless/seamless_map.h"

namespace trimquad {

/// What the directions of the map follow.
struct SeedOptions {
  enum class Follow {
    Smooth,     ///< nothing but smoothness and the aligned edges
    Curvature,  ///< the principal directions where they are distinct
    Given       ///< `guidance`
  };
  Follow follow = Follow::Curvature;
  /// For Follow::Given; by triangle of the region without the bridges of its holes.
  std::optional<FieldGuidance> guidance;
  /// How closely, from 0, not at all, to 1, down to features of a fortieth of the region's size. Without one:
  /// 0.1 for the curvature, 1 for what is given.
  std::optional<double> weight;
  double edgeLength = 1;  ///< of a quad, model units
  enum class Singularities {
    Weighed,  ///< against the distortion of a map without them
    None,     ///< only a map without them is wanted, however much distortion it has
    OfField   ///< those of the smoothest field
  };
  Singularities singularities = Singularities::Weighed;
};

/// A field and the seamless map that follows it: what the rest of the pipeline starts from. (The input of the
/// paper, section 3)
struct Seed {
  CrossField field;
  SeamlessMap map;
  /// Where the map's mesh has halved edges (`map.refined`), the field is of that mesh as well.
  int fieldEdits = 0;  ///< smoother fields that were tried because no map followed the first one
  double fieldSeconds = 0, seamlessSeconds = 0;
};

/// A map without singularities where the region has one of little distortion, or of less than with them, and
/// nothing is to be followed more closely than is usual for the curvature; else the map of the smoothest
/// field. SeedOptions::singularities may ask for either. Where a field has no locally injective map, smoother
/// ones with fewer singularities are tried, down to one that follows nothing but the aligned edges. Throws
/// Error(Stage) of the first field where none has a map, and where the region has no map without
/// singularities though only that is wanted: it is not of genus 0 with a boundary, or is to follow edges,
/// points or given directions.
Seed seed(const Region& region, const SeedOptions& options, const Progress& progress);

}  // namespace trimquad
