#pragma once

#include <vector>

#include "trimquad/mesh/feature_options.h"
#include "trimquad/mesh/region.h"

namespace trimquad {

/// A point of a curve that is to become a feature point.
struct CurvePoint {
  CurveId curve;
  double parameter;
};

/// Makes vertices of the wanted points (FeatureOptions::points) of a model with true surfaces, before it is
/// remeshed. Points inside a region and in corners become its feature points; those on a curve are returned.
/// Throws Error(Input, "options") for a point that is not on the surface.
std::vector<CurvePoint> pinPoints(Model& model, const FeatureOptions& options);

/// Makes the points ends of pieces, by moving the nearest division point or by a new one.
void divideAt(const std::vector<CurvePoint>& points, std::vector<std::vector<double>>& division);

/// Adds the vertices that a remeshed region has at these points to its feature points.
void markCurvePoints(Region& region, const std::vector<CurvePoint>& points);

}  // namespace trimquad
