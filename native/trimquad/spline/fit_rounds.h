#pragma once

#include <array>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include "trimquad/base/error.h"
#include "trimquad/spline/deviation.h"
#include "trimquad/spline/fit_bulges.h"
#include "trimquad/spline/fit_folds.h"
#include "trimquad/spline/fit_surface.h"
#include "trimquad/spline/fitted_region.h"
#include "trimquad/spline/spline_space.h"

namespace trimquad {

/// The rounds of a fit, of one surface or of several that are joined: solve, measure, then correct the
/// parameters or insert knots, until the tolerance holds. What the surfaces are is left to the derived class.
class FitRounds {
 public:
  virtual ~FitRounds() = default;

  /// The surfaces in `surfaces`, by chart; such as are within what is enough where the tolerance cannot be
  /// reached. Throws Error(Stage, "fit") where not even those are.
  FittedSurface run();

  /// As smoothedCharts().
  std::optional<FittedSurface> smoothed(const FittedSurface& fitted, const std::map<int, int>& steps);

  /// As closerCharts().
  std::optional<FittedSurface> closer(const FittedSurface& fitted, const std::vector<int>& chosen);

  /// The smallest deviation so far.
  double closest() const { return best_; }

 protected:
  struct Policy {
    int maxRounds, maxPoles;
    bool takesBack;    ///< corrections that made things worse
    bool failsAtFeet;  ///< knots go where the failing control samples' feet are, not their parameters
    bool several;      ///< surfaces, for messages
    FoldSpots::Policy folds = {};
  };
  FitRounds(const Region& region, const FitOptions& options, const Policy& policy, const Progress& progress);
  /// To be called by the derived class's constructor.
  /// \param mapArea quads^2
  /// \param extent  side of a small triangle's image, quads
  void setScale(double surfaceArea, double mapArea, double extent);

  virtual int charts() const = 0;
  virtual const SplineSpace& space(int chart) const = 0;
  virtual std::vector<SurfaceSample> makeSamples(bool control) = 0;
  /// Of the samples made last.
  virtual const std::vector<std::array<int, 3>>& cells() const = 0;
  virtual std::optional<std::vector<SplineSurface>> leastSquares(
      const std::vector<std::vector<Datum>>& data) const = 0;
  /// Of several surfaces: the same, with the charts that are not chosen as they are in `surfaces`.
  virtual std::optional<std::vector<SplineSurface>> partOfLeastSquares(
      const std::vector<std::vector<Datum>>& /*data*/, const std::vector<int>& /*chosen*/,
      std::vector<SplineSurface> /*surfaces*/) const {
    return {};
  }
  /// Of several surfaces.
  virtual JoinedKnots* joinedKnots() { return nullptr; }
  /// Of some of several surfaces, which stay the same.
  virtual void halveKnots(const std::vector<int>& /*chosen*/) {}
  struct Foot {
    FitPlace at, start;    ///< `start`: where the search began, as seen from the foot's chart
    bool limited = false;  ///< a crease ended the way to it
  };
  /// The sides of a place's knot rectangle, quads; the longer one.
  Eigen::Vector2d knotIntervals(const FitPlace& x) const;
  double knotInterval(const FitPlace& x) const { return knotIntervals(x).maxCoeff(); }
  /// The foot of a point, from a place near it.
  virtual Foot foot(const Eigen::Vector3d& p, const FitPlace& from) const = 0;
  /// Of several surfaces: FitView::seenFrom, isInChart; whether a place lies on a crease that they follow.
  virtual std::optional<Eigen::Vector2d> seenFrom(int /*chart*/, const FitPlace& x) const {
    return x.parameter;
  }
  virtual bool isInChart(const FitPlace&) const { return true; }
  virtual bool isOnCrease(const FitPlace&) const { return false; }
  /// The same: places all along borders, where no small triangle between samples lies.
  virtual std::vector<FitPlace> borderPlaces() const { return {}; }
  /// By chart. \param emphasis by sample: factor of its weight
  std::vector<std::vector<Datum>> dataOf(const std::vector<SurfaceSample>& samples,
                                         const std::vector<double>& emphasis) const;
  /// Whether the sample's parameter is not to be corrected.
  virtual bool isHeld(const SurfaceSample&) const { return false; }
  /// Knots where samples fail, and where others than these are turned over for want of them; false where none
  /// can be inserted.
  virtual bool insertKnots() = 0;
  /// Sets anew as many knots as the bending of the surfaces asks for a deviation, for part of the poles at
  /// most; false where that is not done.
  virtual bool respaceByBending(double /*deviation*/, double /*part*/) { return false; }
  /// The same as the residual asks, for part of the knots at least.
  virtual bool respaceByResidual(double /*deviation*/, double /*part*/) { return false; }
  /// Called before knots are inserted where the refinement before brought little.
  virtual void giveWay() {}

  const Region& region_;
  const double tolerance_, enough_;
  const int threads_, maxPoles_;
  const long maxWork_;  ///< of the progress, with what was done before
  const Progress& progress_;
  FittedSurface result_;
  std::vector<SurfaceSample> samples_;
  std::vector<std::array<int, 3>> cells_;
  std::vector<FitPlace> failing_, turned_;
  std::vector<FitPlace> folds_;  ///< feet of control samples where the surface is turned over
  Fairness fairness_;
  double narrowest_ = 0;  ///< knot interval, quads
  double toleranceInQuads_ = 0;

 private:
  /// Part of the samples at which the surface may be turned over in folds within what is enough, where no
  /// surface without them is found.
  static constexpr double kSmallFolds = 3e-3;
  /// Part of the deviation that a round of parameter correction has to leave at most for another to be worth
  /// it.
  static constexpr double kCorrectionPays = 0.85;
  /// So many tolerances are close.
  static constexpr double kClose = 3;

  struct State {
    std::vector<SurfaceSample> samples;
    std::vector<FitPlace> feet, failing;
    std::vector<SplineSurface> surfaces;
    Deviation deviation;
    BetweenFeet between;
  };

  FittedSurface rounds();
  void continueFrom(const FittedSurface& fitted);
  void takeSamples();
  void keepSheetsApart();
  void holdCorners();
  void solve();
  std::optional<Bulge> bulgeAt(const FitPlace& x) const;
  Deviation measure(std::vector<SurfaceSample>& samples, std::vector<FitPlace>& feet) const;
  static std::vector<FitPlace> places(const std::vector<SurfaceSample>& samples, double above);
  static std::vector<FitPlace> places(const std::vector<SurfaceSample>& samples,
                                      const std::vector<int>& chosen);
  BetweenFeet lookBetweenFeet(const Deviation& deviation, bool forBulges) const;
  void measureFit();
  void noteTurned(const std::vector<SurfaceSample>& samples, const Deviation& deviation);
  void moveTo(const std::vector<FitPlace>& places, std::vector<SurfaceSample>& samples) const;
  void correct();
  void smoothParameters();
  void stopSliding();
  void unfold(std::vector<int> turnedOver, const BetweenFeet& between);
  void returnToMap(int sample);
  void chooseParameters();
  void keepIfEnough();
  bool verified(double tolerance, double folds);
  std::shared_ptr<const FittedSurface::Continuation> continuation();
  double threshold(double largest) const;
  bool stalled() const { return best_ > 0.5 * atRefinement_; }
  bool correctionPays() const;
  bool refine();
  FittedSurface economised();
  bool fitsRespaced();
  void stiffen(double factor);
  void stiffenFolds();
  /// Whether only folds are to go yet, and there is fairness where they are.
  bool smoothsFolds() const { return kept_ && !kept_->folded.empty() && foldSpots_.coverFolds(); }
  State state() const;
  void restore(State state);
  int poles() const;
  Error unreachable() const;

  const FittedRegion fitted_;
  const Policy policy_;
  const bool holdsCorners_;
  std::vector<SplineSpace> sampledOver_;  ///< by chart of several surfaces: over whose knots `samples_` are
  std::optional<FittedSurface> kept_;     ///< within what is enough
  FoldSpots foldSpots_;
  BulgeSpots bulgeSpots_;
  Deviation deviation_, previous_;
  BetweenFeet between_;                                    ///< the feet of `samples_`
  Eigen::Vector3d turnedPoint_ = Eigen::Vector3d::Zero();  ///< the first of those turned over
  std::vector<FitPlace> feet_, ofMap_;  ///< by sample: where its foot lies; where the map has it
  std::vector<double> emphasis_;        ///< by sample: factor of its weight
  State beforeCorrection_;
  /// The smallest deviation so far, and the poles that it took.
  struct Closest {
    double deviation = std::numeric_limits<double>::infinity();
    int poles = std::numeric_limits<int>::max();
    void note(double other, int otherPoles) {
      if (other < deviation) *this = {other, otherPoles};
    }
  };
  Closest closest_, closestClean_;  ///< the latter among those that are turned over nowhere
  double start_ = 0, best_ = 0, atRefinement_ = std::numeric_limits<double>::infinity();
  bool slides_;             ///< samples whose parameters are their feet, along the surface
  bool solved_ = false;     ///< the surfaces and their deviation belong to the present knots and parameters
  bool newBulges_ = false;  ///< found in this round where there were none before
  bool thorough_ = false;   ///< the worst places alone did not bring the deviation down
  int rounds_ = 0, corrections_ = 0, stiffened_ = 0, idle_ = 0, foldRounds_ = 0, bulgeRounds_ = 0;
};

}  // namespace trimquad
