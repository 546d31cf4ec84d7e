#pragma once

#include <functional>
#include <string>
#include <vector>

#include "trimquad/spline/trim_model.h"

namespace trimquad::test {

using PlaneFunction = std::function<Eigen::Vector3d(double, double)>;

/// A curve given by a function; its tangent is a central difference.
class FunctionCurve : public TrueCurve {
 public:
  FunctionCurve(double first, double last, std::function<Eigen::Vector3d(double)> f)
      : first_(first), last_(last), f_(std::move(f)) {}
  double first() const override { return first_; }
  double last() const override { return last_; }
  Eigen::Vector3d point(double t) const override { return f_(t); }
  Eigen::Vector3d tangent(double t) const override {
    const double h = 1e-5 * (last_ - first_);
    return (f_(t + h) - f_(t - h)) / (2 * h);
  }
  double closest(const Eigen::Vector3d&, double guess) const override { return guess; }

 private:
  double first_, last_;
  std::function<Eigen::Vector3d(double)> f_;
};

std::vector<double> clampedKnots(int degree, double a, double b, int spans);

/// The spline surface that takes f's values in the Greville points.
SplineSurface interpolated(const PlaneFunction& f, double u0, double u1, int spansU, double v0, double v1,
                           int spansV, int degree = 3);

/// A closed cubic surface over [0, rings] x [v0, v1], whose control points are f at whole u (and at v).
SplineSurface closedSurface(const PlaneFunction& f, int rings, double v0, double v1, int spansV);

/// A model under construction: surfaces that are said to be fitted, and the boundaries to trim them by.
/// Trimming looks at a region's boundary only, so each loop is filled by a fan of its own.
class TrimCase {
 public:
  Model model;
  std::vector<GridMap> maps;
  std::vector<std::optional<FittedSurface>> fits;
  double tolerance = 1e-3;

  CornerId corner(const Eigen::Vector3d& p);
  CurveId curve(double first, double last, CornerId start, CornerId end,
                std::function<Eigen::Vector3d(double)> f, int pieces = 24);
  /// A closed curve with its corner at `first`.
  CurveId closedCurve(double first, double last, std::function<Eigen::Vector3d(double)> f, int pieces = 48);

  struct Use {
    CurveId curve;
    bool forward;
  };
  using Loop = std::vector<Use>;

  /// \param loops   with the region on their left
  /// \param inverse parameters of a point on (or near) the surface
  int region(const SplineSurface& surface, const std::vector<Loop>& loops,
             const std::function<Eigen::Vector2d(const Eigen::Vector3d&)>& inverse);

  SplineModel trim(int threads = 1, TrimMemory* memory = nullptr);

 private:
  std::vector<int> pieces_;  ///< mesh edges, by curve
};

Eigen::Vector2d dropZ(const Eigen::Vector3d& p);

Eigen::Vector3d wavy(double x, double y);

/// A wavy sheet with the rectangle [0, 10] x [0, 6] as its boundary.
TrimCase rectangleSheet();

/// Two wavy sheets, [0, 5] x [0, 6] and [5, 10] x [0, 6], that meet smoothly but for `offset` between their
/// heights, by place.
TrimCase tangentSheets(const std::function<double(double, double)>& offset);

/// A wavy sheet trimmed by a circle of radius 5, with three round holes; the first one, of radius 1, at
/// (holeX, 1).
TrimCase roundSheet(double holeX = 2);

inline constexpr int kRings = 24;

Eigen::Vector2d angleAndZ(const Eigen::Vector3d& p);

/// A tube round the z axis, free ends at wavy heights; holes at the given angles (in quads).
TrimCase tube(const std::vector<Eigen::Vector2d>& holes, double radius = 0.8);

/// Four quarters of a wavy sheet around (5, 3), opposite ones first, that meet smoothly but for `offset`
/// between their heights, by quarter and place.
TrimCase tangentQuarters(const std::function<double(int, double, double)>& offset);

/// Two tubes round the z axis, from z = 1 to a wavy ring about 5 and on to 9, that meet smoothly but for
/// `offset` between their radii, by angle (in quads).
TrimCase tangentTubes(const std::function<double(double)>& offset);

/// A box of size 10 x 8 x 6 around the origin, sides bulging outwards by waves of the given height; only the
/// sides in `which` (2 * axis + (positive side)).
TrimCase bulgedBox(double waves, const std::vector<int>& which = {0, 1, 2, 3, 4, 5});

/// A plate 16 x 10 x 3 with vertical edges rounded by 2 and a round hole of radius 1.5 through it: top,
/// bottom, one ring of sides, and the hole's wall.
TrimCase filletedPlate();

/// Largest distance between any edge's curve and its image on a face, and between vertices and what ends
/// there.
struct ModelGaps {
  double edge = 0, vertex = 0, edgeTolerance = 0, vertexTolerance = 0;
};
ModelGaps measuredGaps(const SplineModel& model, int samples = 777);

}  // namespace trimquad::test
