#include "trimquad/spline/fit_surface.h"

#include <algorithm>
#include <cmath>

#include "trimquad/base/error.h"
#include "trimquad/spline/fit_layout.h"
#include "trimquad/spline/fit_rounds.h"
#include "trimquad/spline/knot_refinement.h"
#include "trimquad/spline/knot_spacing.h"
#include "trimquad/spline/spline_space.h"
#include "trimquad/spline/surface_samples.h"

namespace trimquad {
namespace {

constexpr int kRoundsOfSurface = 100;
constexpr int kPolesOfSurface = 100000;

/// u of the line at which a closed chart is cut: a whole quad, where the line crosses the region in the
/// fewest pieces; the middle of the longest row of such lines, for the fit moves the boundary a little.
Quanta seamOf(const GridMap& map, const Chart& chart) {
  const Quanta one = chart.scale.one(), period = *chart.period;
  const int lines = int(period / one);
  std::vector<int> crossings(lines + 1, 0);
  const auto floorDivide = [](Quanta a, Quanta b) { return a / b - (a % b < 0); };
  std::vector<int> count(lines, 0);
  for (const auto h : map.mesh.halfedges()) {
    if (!map.mesh.is_boundary(h)) continue;
    const HalfedgeHandle inner = map.mesh.opposite_halfedge_handle(h);
    const Quanta a = chart.corner[inner.idx()].u,
                 b = chart.corner[map.mesh.next_halfedge_handle(inner).idx()].u;
    for (Quanta line = floorDivide(std::min(a, b), one) + 1; line * one <= std::max(a, b); ++line)
      ++count[((line % lines) + lines) % lines];
  }
  const int fewest = *std::min_element(count.begin(), count.end());
  int best = 0, bestRun = 0;
  for (int start = 0; start < lines; ++start) {
    int run = 0;
    while (run < lines && count[(start + run) % lines] == fewest) ++run;
    if (run <= bestRun) continue;
    bestRun = run;
    best = run == lines ? 0 : (start + run / 2) % lines;
  }
  return best * one;
}

SplineLine initialLine(int degree, double first, double last, double span, bool closed) {
  SplineLine line{degree, closed, {}};
  const double length = last - first;
  int spans = std::max(1, int(std::lround(length / span)));
  if (closed) spans = std::max(spans, degree + 1);
  while (closed && spans > length && spans & (spans - 1))
    ++spans;  // under one quad a power of two, to be exact
  for (int i = 0; i <= spans; ++i) {
    const double at = length * i / spans;
    line.breaks.push_back(first + (spans <= length ? std::round(at) : at));
  }
  return line;
}

/// The coarsest space: two spans along the longer side of the domain, four around a tube.
SplineSpace initialSpace(const GridMap& map, const Chart& chart, double seam, int degree) {
  Quanta low[2], high[2];
  bool first = true;
  for (const auto h : map.mesh.halfedges()) {
    if (map.mesh.is_boundary(h)) continue;
    const FixedVector x = chart.corner[h.idx()];
    for (int axis = 0; axis < 2; ++axis) {
      low[axis] = first ? x[axis] : std::min(low[axis], x[axis]);
      high[axis] = first ? x[axis] : std::max(high[axis], x[axis]);
    }
    first = false;
  }
  const auto& scale = chart.scale;
  const double lengthU = scale.toQuads(high[0] - low[0]), lengthV = scale.toQuads(high[1] - low[1]);
  // Trim curves are intersections with neighbours and leave the region's image a little.
  const double room = std::max(0.5, 0.01 * std::max(lengthU, lengthV));
  double u0 = std::floor(scale.toQuads(low[0]) - room), u1 = std::ceil(scale.toQuads(high[0]) + room);
  const double v0 = std::floor(scale.toQuads(low[1]) - room), v1 = std::ceil(scale.toQuads(high[1]) + room);
  if (chart.period) {
    u0 = seam;
    u1 = seam + scale.toQuads(*chart.period);
  }
  const double span = chart.period ? (u1 - u0) / 4 : std::max(u1 - u0, v1 - v0) / 2;
  return {initialLine(degree, u0, u1, span, chart.period.has_value()),
          initialLine(degree, v0, v1, span, false)};
}

class SurfaceFit : public FitRounds {
 public:
  SurfaceFit(const Region& region, const GridMap& map, const FitOptions& options, const Chart& chart,
             double seam, const Progress& progress)
      : FitRounds(region, options,
                  {.maxRounds = kRoundsOfSurface,
                   .maxPoles = kPolesOfSurface,
                   .takesBack = false,
                   .failsAtFeet = true,
                   .several = false},
                  progress),
        space_(initialSpace(map, chart, seam, options.degree)),
        source_(region, map, chart, seam, progress) {
    setScale(surfaceArea(map.mesh), source_.chartArea(), source_.triangleExtent());
  }

 private:
  int charts() const override { return 1; }
  const SplineSpace& space(int) const override { return space_; }
  std::vector<SurfaceSample> makeSamples(bool control) override {
    return source_.make(space_, control, threads_, progress_);
  }
  const std::vector<std::array<int, 3>>& cells() const override { return source_.cells(); }
  std::optional<std::vector<SplineSurface>> leastSquares(
      const std::vector<std::vector<Datum>>& data) const override {
    auto surface = space_.leastSquares(data[0], fairness_, progress_);
    if (!surface) return {};
    return std::vector{std::move(*surface)};
  }
  Foot foot(const Eigen::Vector3d& p, const FitPlace& from) const override {
    return {{0, result_.surfaces[0].footPoint(p, from.parameter, kFootStep)}, from};
  }
  bool insertKnots() override {
    std::vector<Eigen::Vector2d> failing;
    for (const auto& x : failing_) failing.push_back(x.parameter);
    return refineKnots(space_, samples_, cells_, failing, narrowest_);
  }

  bool respaceByBending(double deviation, double part) override {
    auto demand = demandOfBending(result_.surfaces[0], space_, samples_, deviation);
    limitPoles(demand, space_, part * space_.poles());
    respace(demand);
    return true;
  }
  bool respaceByResidual(double deviation, double part) override {
    respace(demandOfResidual(space_, samples_, cells_, deviation, part));
    return true;
  }
  void respace(const KnotDemand& demand) {
    space_.u = respaced(space_.u, demand[0]);
    space_.v = respaced(space_.v, demand[1]);
  }

  SplineSpace space_;
  SurfaceSamples source_;
};

}  // namespace

FittedSurface fitSurface(const Region& region, const GridMap& map, const FitOptions& options,
                         const Progress& progress) {
  if (!(options.tolerance > 0) || !std::isfinite(options.tolerance))
    throw inputError("fit", "the tolerance must be a positive number");
  if (options.degree < 2 || options.degree > 5) throw inputError("fit", "the degree must be 2, 3, 4 or 5");
  auto single = singleChart(map);
  if (!single || !options.bisections.empty() ||
      std::any_of(map.aligned.begin(), map.aligned.end(),
                  [&](EdgeHandle e) { return !map.mesh.is_boundary(e); }))
    return fitLayout(region, map, layout(map, options.bisections, progress), options, progress);
  Chart unrolled = options.smallestRectangle && !single->period ? turnedToSmallestRectangle(*single, map.mesh)
                                                                : std::move(*single);
  const double seam = unrolled.period ? unrolled.scale.toQuads(seamOf(map, unrolled)) : 0;
  FittedSurface fitted = SurfaceFit(region, map, options, unrolled, seam, progress).run();
  fitted.surface = std::move(fitted.surfaces[0]);
  fitted.surfaces.clear();
  fitted.chart = std::move(unrolled);
  return fitted;
}

}  // namespace trimquad
