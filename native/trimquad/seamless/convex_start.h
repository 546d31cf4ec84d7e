#pragma once

#include <optional>

#include "trimquad/seamless/seam_basis.h"

namespace trimquad {

/// A locally injective map of a region of genus 0 without singularities, coordinates x of the basis: outer
/// loop on a circle, or the two ends of a tube on two lines; holes are bridged by one vertex each; every
/// inner vertex is the mean of its neighbours. (Tutte 1963; for tubes Gortler, Gotsman, Thurston 2006)
/// Triangles are positive but for rounding. Empty for other regions.
/// \param period  of the tube, in quads and along u, where there is one
std::optional<Eigen::VectorXd> convexStart(const SurfaceMesh& mesh, const SeamGraph& seams,
                                           const SeamBasis& basis, double area, std::optional<double> period);

}  // namespace trimquad
