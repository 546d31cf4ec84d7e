#pragma once

#include <array>
#include <vector>

#include "trimquad/base/progress.h"
#include "trimquad/mesh/region.h"
#include "trimquad/spline/spline_model.h"

namespace trimquad {

/// A trimmed face in small triangles, and how far its points lie from the region that it stands for.
struct DeviationMap {
  std::vector<Eigen::Vector3d> points;        ///< on the face's surface
  std::vector<double> distances;              ///< of the points from the region, model units
  std::vector<std::array<int, 3>> triangles;  ///< counter-clockwise seen from outside
};

struct DeviationMapOptions {
  double chord;     ///< largest distance of a triangle from its face, model units
  double size;      ///< largest side of a triangle, model units
  int threads = 1;  ///< the result does not depend on it
};

/// Of each face of a model, in the model's order: OpenCASCADE's triangles, halved at their longest sides
/// until these are short, all corners on the surface itself. Distances are to the surface behind the region's
/// triangles, to these where there is none, from the side that the face looks to; so they tell where the
/// model leaves its input, which the fit's own deviation, of the input's points from the surfaces, does not.
/// \param regions of the model; null where no face is of it
/// Throws Error(Stage, "write") where OpenCASCADE cannot triangulate a face.
std::vector<DeviationMap> deviationMaps(const SplineModel& model, const std::vector<const Region*>& regions,
                                        const DeviationMapOptions& options, const Progress& progress);

}  // namespace trimquad
