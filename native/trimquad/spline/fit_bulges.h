#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "trimquad/spline/fit_folds.h"
#include "trimquad/spline/fitted_region.h"

namespace trimquad {

/// The bulge at a place of a surface, or on the way up from there where it is near one: distances from
/// triangles rise to sharp ridges, narrower than the way between places that are looked at. None elsewhere.
/// \param knotIntervals the sides of the place's knot rectangle, quads
/// \param isInChart     whether a place belongs to the surface
std::optional<Bulge> bulgeNear(const FittedRegion& region, const SplineSurface& surface,
                               const Eigen::Vector2d& at, const Eigen::Vector2d& knotIntervals,
                               const std::function<bool(const Eigen::Vector2d&)>& isInChart);

/// Where surfaces had bulges between the feet of samples, at least once. Each is one of the places of the fit
/// from then on, to come back to the region from where the surface is.
class BulgeSpots {
 public:
  /// What comes again counts more. Whether there are any.
  /// \param knotIntervals by place: the sides of its knot rectangle, quads
  bool note(const std::vector<FitPlace>& bulges,
            const std::function<Eigen::Vector2d(const FitPlace&)>& knotIntervals);
  /// \param target by place: the region's point there
  /// \param data   by chart; appended to
  void appendTo(std::vector<std::vector<Datum>>& data,
                const std::function<Eigen::Vector3d(const FitPlace&)>& target) const;

 private:
  struct Spot {
    FitPlace at;
    Eigen::Vector2d reach;  ///< quads, along u and v
    double weight;          ///< of the surface's way back to the region there, quads^2
  };
  std::vector<Spot> spots_;
};

}  // namespace trimquad
