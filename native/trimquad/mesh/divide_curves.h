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

/// The larger principal curvature of a surface, without sign, 1 / model unit.
double largestCurvature(const TrueSurface& surface, const Eigen::Vector3d& point);

/// The longest edge that such a curvature allows, at most the wanted one.
double lengthByCurvature(double curvature, const RemeshOptions& options);

/// Whether a surface that bends like that along a curve has an edge there, within the tolerance.
inline bool isSharp(double curvature, const RemeshOptions& options) {
  return curvature * options.tolerance >= 1;
}

/// Divides the chosen curves, along which regions bend, into as short pieces as these ask for beside them.
/// Where the radius is below the tolerance the curve is an edge to both, which may be divided as before.
void divideByCurvature(const Model& model, const std::vector<char>& chosen, const RemeshOptions& options,
                       std::vector<std::vector<double>>& division);

/// Growth of the wanted length per length.
inline constexpr double kGradation = 0.4;

}  // namespace trimquad
