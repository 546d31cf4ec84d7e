#pragma once

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "trimquad/mesh/aabb_tree.h"
#include "trimquad/spline/spline_space.h"
#include "trimquad/spline/surface_samples.h"

namespace trimquad {

/// A parameter of one of the fitted surfaces.
struct FitPlace {
  int chart;
  Eigen::Vector2d parameter;
  /// Of a foot: projects onto the directions in which it may move.
  Eigen::Matrix3d free = Eigen::Matrix3d::Zero();
};

/// Those of the small triangles between samples that have a corner among the chosen samples.
std::vector<std::array<int, 3>> cellsAround(const std::vector<std::array<int, 3>>& cells,
                                            const std::vector<int>& chosen);

/// Whether surfaces stay within a distance of the region all over small triangles between samples: samples
/// see the surfaces only where the region is, not the folds between them. Triangles between charts are left
/// out.
bool stayNear(const std::vector<SplineSurface>& surfaces, const std::vector<SurfaceSample>& samples,
              const std::vector<std::array<int, 3>>& cells, const TriangleTree& region, double distance);

/// Places between the feet of samples.
struct BetweenFeet {
  std::vector<FitPlace> away;        ///< a surface is farther from the region than that
  std::vector<FitPlace> turnedOver;  ///< a surface is turned over against the samples around
  std::vector<int> turnedOverCells;  ///< those around them, once or more
};

/// What the fit knows of its surfaces.
struct FitView {
  /// A place in the plane of a chart; none where that is not next to its own.
  std::function<std::optional<Eigen::Vector2d>(int chart, const FitPlace&)> seenFrom;
  std::function<bool(const FitPlace&)> isInChart;  ///< not beyond a border
  /// The longer side of its knot rectangle, quads.
  std::function<double(const FitPlace&)> knotInterval;
  /// Whether the region faces that way near a point.
  std::function<bool(const Eigen::Vector3d& p, const Eigen::Vector3d& normal)> facesLikewise;
  /// Whether a surface is farther from the region there than it may be.
  std::function<bool(const FitPlace&)> isAway;
};

/// Looks at the surfaces within small triangles between samples, as far apart as their feet are: feet avoid
/// bulges and folds between them.
/// \param feet of the samples
/// \param view  without `isAway` nothing is away
BetweenFeet betweenFeet(const std::vector<SplineSurface>& surfaces, const std::vector<SurfaceSample>& samples,
                        const std::vector<FitPlace>& feet, const std::vector<std::array<int, 3>>& cells,
                        const FitView& view, int threads, const Progress& progress);

/// As much fairness on the knot rectangles of some charts as the tolerance allows: more where samples on one
/// and around it are well within, less where they come close to it, but no less than without.
class RectangleStiffness {
 public:
  /// \param spaces by chart  \param steps by chart: how often its fairness changes
  RectangleStiffness(const std::vector<const SplineSpace*>& spaces, const std::map<int, int>& steps);
  /// The next step. Whether there was one left.
  bool update(const std::vector<SurfaceSample>& samples, double tolerance);
  /// As Fairness::stiffness.
  const std::vector<std::vector<double>>& factors() const { return factors_; }

 private:
  void updateChart(int chart, const std::vector<double>& largest, double tolerance);

  std::vector<const SplineSpace*> spaces_;
  std::map<int, int> steps_;  ///< left
  std::vector<std::vector<double>> factors_;
};

/// Places of more fairness where surfaces are turned over in few places.
class FoldSpots {
 public:
  struct Policy {
    /// Of the fairness at first, relative to that of the knot rectangle; none: as on a whole quad.
    std::optional<double> strength = {};
    double step = 4;  ///< factor by which it changes
  };
  explicit FoldSpots(const Policy& policy) : policy_(policy) {}

  /// More of it where folds lie, the more the longer they stay; and less again where samples fail, for it may
  /// keep them from the tolerance.
  /// \param knotInterval by place: the longer side of its knot rectangle, quads
  void update(const std::vector<FitPlace>& folds, const std::vector<FitPlace>& failing,
              const std::function<double(const FitPlace&)>& knotInterval);
  const std::vector<Fairness::Spot>& spots() const { return spots_; }
  /// Whether there were folds last time, and all of them lie in spots. Where knot intervals are wide, knots
  /// are missing instead.
  bool coverFolds() const { return coverFolds_; }

 private:
  double firstFactor(double knotInterval) const;

  Policy policy_;
  std::vector<Fairness::Spot> spots_;
  bool coverFolds_ = false;
};

}  // namespace trimquad
