#pragma once

#include <vector>

#include "trimquad/mesh/region.h"

namespace trimquad {

struct RemeshOptions {
  double edgeLength;  ///< wanted, model units
  double tolerance;   ///< wanted distance between triangles and surface, model units
};

/// The shortest edge that curvature asks for by its turn, as a share of the wanted length.
inline constexpr double kShortestEdge = 0.2;
/// The same where the tolerance would not be kept otherwise.
inline constexpr double kTightestEdge = 0.02;
/// An edge spans at most this angle of a curve or surface (radians), unless it would be shorter than that.
inline constexpr double kLargestTurn = 0.8;

/// Where each curve of a model is divided: parameters in ascending order with both ends, by curve index.
/// Pieces have equal lengths of about the wanted one, and are within tolerance of the curve unless that asks
/// for very short ones. Curves shorter than the wanted length stay one piece, unless two pieces would join
/// the same two vertices.
std::vector<std::vector<double>> divideCurves(const Model& model, const RemeshOptions& options);

}  // namespace trimquad
